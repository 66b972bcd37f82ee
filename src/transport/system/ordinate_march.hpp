// One ordinate's march through the box: along z, and through runs of levels along x or y. The slopes of its source
// (docs/theory.md, "March along the dominant axis", "Slopes within cells").
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "transport/rays/march.hpp"
#include "transport/system/sweep.hpp"

namespace cloudbow {

template <class Real>
CellView<Real> view_along_z(const Cells<Real>& cells, const GroupGradient<Real>& of) {
  return cells.view(cells.extinction, of.axis[0], of.axis[1], of.axis[2]);
}
template <class Real>
CellView<Real> view_along_y(const Cells<Real>& cells, const GroupGradient<Real>& of) {
  return cells.view(cells.extinction, of.axis[0], of.axis[2], of.axis[1]);
}
template <class Real>
CellView<Real> view_along_x(const Cells<Real>& cells, const GroupGradient<Real>& of) {
  return cells.view(cells.transposed[0].extinction, of.transposed[1], of.transposed[2], of.transposed[0]);
}

// Values of the cells of some levels in the order of a march along x.
template <class Real>
void transpose_cells(const Cells<Real>& cells, LevelRange levels, const Real* __restrict from, Real* __restrict to) {
  const std::uint32_t* __restrict const cell = cells.transposed[0].cell.data();
  const std::size_t last = cells.rows.level_cell[levels.last];
  for (std::size_t c = cells.rows.level_cell[levels.first]; c < last; ++c) to[c] = from[cell[c]];
}

// Adds such values to those of the cells.
template <class Real>
void add_transposed(const Cells<Real>& cells, LevelRange levels, const Real* __restrict from, Real* __restrict to) {
  const std::uint32_t* __restrict const cell = cells.transposed[0].cell.data();
  const std::size_t last = cells.rows.level_cell[levels.last];
  for (std::size_t c = cells.rows.level_cell[levels.first]; c < last; ++c) to[cell[c]] += from[c];
}

// Slopes of an ordinate's source in n cells from `first` on. They are mixed of those of its octant, of the beam and of
// the Planck radiance. @param source [n] of these cells.
template <class Real>
void mix_slopes_of_cells(const TransportSystem<Real>& system, const LightSlopes<Real>& slopes, int d, std::size_t first,
                         std::size_t n, const Real* source, typename SweepWorkspace<Real>::Thread& work) {
  work.from_beam.assign(n, Real(0));
  for (const BeamSource<Real>& beam : system.beam.source) {
    const Real phase = beam.direction[d];
    const Real* __restrict const intensity = beam.intensity.data() + first;
    Real* __restrict const to = work.from_beam.data();
    for (std::size_t c = 0; c < n; ++c) to[c] += phase * intensity[c];
  }
  mix_slopes(slopes.of_octant[octant_of(system.ordinates.direction[d])], system.slopes->beam(),
             system.thermal_emission(), first, n, source, work.from_beam.data(), work.gradient.axis);
}

// The same of all cells, also in the order of a march along x.
template <class Real>
void mix_slopes_of_ordinate(const TransportSystem<Real>& system, const LightSlopes<Real>& slopes, int d,
                            const Real* source, typename SweepWorkspace<Real>::Thread& work) {
  const std::size_t n = system.cells->size();
  mix_slopes_of_cells(system, slopes, d, 0, n, source, work);
  for (auto& axis : work.gradient.transposed) axis.resize(system.paths[d].goes_along_x() ? n + lane_padding : 0);
  for (const SidewaysPath& path : system.paths[d].sideways) {
    if (path.axis != 0) continue;
    for (std::size_t axis = 0; axis < 3; ++axis)
      transpose_cells(*system.cells, path.levels, work.gradient.axis[axis].data(),
                      work.gradient.transposed[axis].data());
  }
}

// The same from differences between neighbours.
template <class Real>
void gradient_of_ordinate(const TransportSystem<Real>& system, const Real* source,
                          typename SweepWorkspace<Real>::Thread& work) {
  const std::size_t n = system.cells->size();
  for (auto& axis : work.gradient.axis) axis.resize(n + lane_padding);
  Real* const x = work.gradient.axis[0].data();
  Real* const y = work.gradient.axis[1].data();
  Real* const z = work.gradient.axis[2].data();
  const CellEmission<Real> emission = system.thermal_emission();
  if (emission.source == nullptr) {
    source_gradient(*system.cells, 0, n, source, x, y, z);
    return;
  }
  work.rest.resize(n);
  for (std::size_t c = 0; c < n; ++c) work.rest[c] = source[c] - emission.source[c];
  source_gradient(*system.cells, emission, 0, n, source, work.rest.data(), x, y, z);
}

/// Contribution of one ordinate's march; summed over ordinates in their order.
struct OrdinateFluxes {
  double out = 0;  ///< through the top, sum of radiances
  MarchTotals sides;
  std::vector<double> profile;  ///< [nz+1] by height, sum of radiances
};

// Light on a horizontal plane, [ny][nx], when its rays are `x`, `y` columns from their launch points.
template <class Real>
void shift_columns(const BoxGrid& box, double x, double y, const Real* from, Real* to) {
  const int sx = wrapped(static_cast<int>(std::floor(x)), box.nx);
  const int sy = wrapped(static_cast<int>(std::floor(y)), box.ny);
  for (int r = 0; r < box.ny; ++r) {
    const Real* const source = from + static_cast<std::size_t>(r) * box.nx;
    Real* const target = to + static_cast<std::size_t>((r + sy) % box.ny) * box.nx;
    std::copy(source, source + (box.nx - sx), target + sx);
    std::copy(source + (box.nx - sx), source + box.nx, target);
  }
}

// [ny][nx] to [nx][ny], in tiles that stay in the nearest cache.
template <class Real>
void transpose(const Real* from, int nx, int ny, Real* to) {
  constexpr int tile = 16;
  for (int first_j = 0; first_j < ny; first_j += tile) {
    const int last_j = std::min(ny, first_j + tile);
    for (int first_i = 0; first_i < nx; first_i += tile) {
      const int last_i = std::min(nx, first_i + tile);
      for (int i = first_i; i < last_i; ++i) {
        for (int j = first_j; j < last_j; ++j)
          to[static_cast<std::size_t>(i) * ny + j] = from[static_cast<std::size_t>(j) * nx + i];
      }
    }
  }
}

// One thread's march of one ordinate after another.
template <class Real>
class OrdinateMarch {
 public:
  // @param mixed slopes that ordinates without a march along x or y mix level by level; null: gradients are at hand.
  OrdinateMarch(const TransportSystem<Real>& system, const LightSlopes<Real>* mixed,
                typename SweepWorkspace<Real>::Thread& work)
      : system_(system), mixed_(mixed), work_(work) {}

  // `rays` [columns + lane_padding] come in by column.
  // @param passing [levels + 1][columns] radiance at each interface; null: not kept.
  // @param keep_moments of the radiance, in work.moment.
  void cross_box(int d, const GroupGradient<Real>& gradient, std::vector<Real>& source, ArrivingRays<Real>& rays,
                 bool record, bool keep_moments, Real* passing, OrdinateFluxes& totals) {
    const OrdinatePath& path = system_.paths[d];
    std::vector<Real>& radiance = rays.radiance;
    work_.mean.resize(source.size());
    sums_ = {work_.mean.data(), {}};
    for (std::size_t axis = 0; keep_moments && axis < 3; ++axis) {
      work_.moment[axis].resize(source.size());
      sums_.moment[axis] = work_.moment[axis].data();
    }
    clear_sums(system_.cells->size(), source.size());
    if (record) totals.profile.assign(system_.box.nz() + 1, 0.);
    go_along_z(d, path.along_z.front(), gradient, source, radiance, record, passing, totals);
    bool sum_alone = false;
    for (std::size_t run = 0; run < path.sideways.size(); ++run) {
      put_in_columns(path.along_z[run], radiance);
      const PathPattern& next = path.along_z[run + 1];
      sum_alone = path.upward && run + 1 == path.sideways.size() && next.levels() == 0;
      go_sideways(path.sideways[run], gradient, source, radiance, record, sum_alone, totals);
      go_along_z(d, next, gradient, source, radiance, record, passing, totals);
    }
    if (path.upward && !sum_alone) totals.out = plane_sum(radiance.data(), system_.box.columns());
    const PathPattern& last = path.along_z.back();
    rays.shift_x = last.levels() > 0 ? static_cast<int>(std::floor(last.x.back())) : 0;
    rays.shift_y = last.levels() > 0 ? static_cast<int>(std::floor(last.y.back())) : 0;
    source.swap(work_.mean);
  }

 private:
  // Levels along z are cleared as the march comes to them.
  void clear_sums(std::size_t first, std::size_t last) {
    std::fill(sums_.mean + first, sums_.mean + last, Real(0));
    for (Real* const moment : sums_.moment) {
      if (moment != nullptr) std::fill(moment + first, moment + last, Real(0));
    }
  }

  void go_along_z(int d, const PathPattern& pattern, const GroupGradient<Real>& gradient,
                  const std::vector<Real>& source, std::vector<Real>& rays, bool record, Real* passing,
                  OrdinateFluxes& totals) {
    if (pattern.levels() == 0) return;
    const std::size_t columns = system_.box.columns();
    const std::span<const Real> side =
        system_.side_radiance.empty() ? std::span<const Real>{} : std::span<const Real>(system_.side_radiance[d]);
    const auto at_level = [&](int step, const Real* p, MarchedRays<Real>& all) {
      if (!record) return;
      const int edge = pattern.first_level + (pattern.upward ? step : pattern.levels() - step);
      totals.profile[edge] = p != nullptr ? plane_sum(p, columns) : all.sum();
      if (p != nullptr && passing != nullptr) std::copy_n(p, columns, passing + edge * columns);
    };
    const Cells<Real>& cells = *system_.cells;
    const bool by_level = mixed_ != nullptr && system_.paths[d].sideways.empty();
    const MarchedCells<Real> all{
        0, by_level ? CellView<Real>(cells.view(cells.extinction, {}, {}, {})) : view_along_z(cells, gradient),
        source.data(), sums_};
    const auto of_level = [&](int level) {
      const std::size_t first = cells.rows.level_cell[level], last = cells.rows.level_cell[level + 1];
      clear_sums(first, last);
      MarchedCells<Real> marched = all.from(first);
      if (!by_level) return marched;
      mix_slopes_of_cells(system_, *mixed_, d, first, last - first, marched.source, work_);
      for (std::size_t axis = 0; axis < 3; ++axis) marched.view.gradient[axis] = work_.gradient.axis[axis].data();
      return marched;
    };
    const MarchTotals sides =
        march_by_level<Real, true>(pattern, cells.rows, cells.extinction.data(), system_.box.periodic, side, of_level,
                                   rays.data(), passing == nullptr, at_level);
    totals.sides.entered_sides += sides.entered_sides;
    totals.sides.left_sides += sides.left_sides;
  }

  // Moves rays to the columns in which the pattern ends.
  void put_in_columns(const PathPattern& pattern, std::vector<Real>& rays) {
    if (pattern.levels() == 0) return;
    work_.plane.resize(rays.size());
    shift_columns(system_.box, pattern.x.back(), pattern.y.back(), rays.data(), work_.plane.data());
    rays.swap(work_.plane);
  }

  void go_sideways(const SidewaysPath& path, const GroupGradient<Real>& gradient, const std::vector<Real>& source,
                   std::vector<Real>& rays, bool record, bool sum_alone, OrdinateFluxes& totals) {
    const Cells<Real>& cells = *system_.cells;
    const std::size_t columns = system_.box.columns();
    const bool along_x = path.axis == 0;
    SidewaysPlanes<Real> planes;
    planes.everywhere = rays[0];
    if (std::any_of(rays.begin() + 1, rays.begin() + static_cast<std::ptrdiff_t>(columns),
                    [&](Real r) { return r != rays[0]; })) {
      if (along_x) {
        work_.plane.resize(columns + lane_padding);
        transpose(rays.data(), system_.box.nx, system_.box.ny, work_.plane.data());
        rays.swap(work_.plane);
      }
      planes.entering = std::span<const Real>(rays).first(columns);
    }
    if (!sum_alone) {
      work_.plane.assign(columns + lane_padding, Real(0));
      planes.leaving = std::span<Real>(work_.plane).first(columns);
    }
    std::vector<double> at_level(record ? path.levels.last - path.levels.first + 1 : 0, 0.);
    planes.at_level = at_level;
    const TransposedCells<Real>& transposed = cells.transposed[path.axis];
    clear_sums(cells.rows.level_cell[path.levels.first], cells.rows.level_cell[path.levels.last]);
    if (along_x) {
      const std::size_t n = cells.size();
      const std::size_t first = cells.rows.level_cell[path.levels.first];
      const std::size_t last = cells.rows.level_cell[path.levels.last];
      const auto start_sum = [&](std::vector<Real>& sum) {
        sum.resize(n + lane_padding);
        std::fill(sum.begin() + first, sum.begin() + last, Real(0));
        return sum.data();
      };
      work_.transposed_source.resize(n + lane_padding);
      transpose_cells(cells, path.levels, source.data(), work_.transposed_source.data());
      // The axes of a march along x are y, z, x.
      constexpr std::array<std::size_t, 3> axis_of_box{1, 2, 0};
      CellSums<Real> sums{start_sum(work_.transposed_mean), {}};
      for (std::size_t axis = 0; sums_.keeps_moments() && axis < 3; ++axis)
        sums.moment[axis] = start_sum(work_.transposed_moment[axis]);
      march_sideways(path, transposed.sheets, transposed.gaps, view_along_x(cells, gradient),
                     work_.transposed_source.data(), planes, sums, work_.sideways);
      add_transposed(cells, path.levels, work_.transposed_mean.data(), work_.mean.data());
      for (std::size_t axis = 0; sums_.keeps_moments() && axis < 3; ++axis)
        add_transposed(cells, path.levels, work_.transposed_moment[axis].data(),
                       work_.moment[axis_of_box[axis]].data());
    } else {
      const CellSums<Real> sums{sums_.mean, {sums_.moment[0], sums_.moment[2], sums_.moment[1]}};
      march_sideways(path, transposed.sheets, transposed.gaps, view_along_y(cells, gradient), source.data(), planes,
                     sums, work_.sideways);
    }
    std::copy(at_level.begin(), at_level.end(), totals.profile.begin() + (record ? path.levels.first : 0));
    totals.out = planes.left;
    if (sum_alone) return;
    if (along_x) {
      transpose(work_.plane.data(), system_.box.ny, system_.box.nx, rays.data());
    } else {
      rays.swap(work_.plane);
    }
  }

  const TransportSystem<Real>& system_;
  const LightSlopes<Real>* mixed_;
  typename SweepWorkspace<Real>::Thread& work_;
  CellSums<Real> sums_;
};

}  // namespace cloudbow
