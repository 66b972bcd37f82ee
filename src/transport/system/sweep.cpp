#include "transport/system/sweep.hpp"

#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "cloudbow/core/parallel_errors.hpp"
#include "transport/rays/march.hpp"
#include "transport/system/arriving_sum.hpp"

namespace cloudbow {
namespace {

constexpr std::size_t block_cells = 4096;  // a thread's share of loops over cells

// Whether the ordinates of an octant share the gradient of their mean source; else each has its own, or there is none.
template <class Real>
bool shares_gradients(const TransportSystem<Real>& system) {
  return system.linear_source && system.cells->heterogeneous;
}

// Ordinates that are marched side by side: an octant's if they share slopes or a gradient, else all.
template <class Real>
std::vector<std::vector<int>> groups_side_by_side(const TransportSystem<Real>& system, bool by_octant, bool upward) {
  std::vector<std::vector<int>> groups;
  std::array<int, 4> of_quadrant{-1, -1, -1, -1};
  for (int d = 0; d < system.ordinates.size(); ++d) {
    const Direction& o = system.ordinates.direction[d];
    if ((o.z() > 0) != upward) continue;
    int& group = of_quadrant[by_octant ? (o.x() > 0 ? 1 : 0) + (o.y() > 0 ? 2 : 0) : 0];
    if (group < 0) {
      group = static_cast<int>(groups.size());
      groups.emplace_back();
    }
    groups[group].push_back(d);
  }
  return groups;
}

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

// Gradient of the mean source of some ordinates. Called by all threads of a team.
template <class Real>
void team_make_gradient(const TransportSystem<Real>& system, const AngularField<Real>& field,
                        const std::vector<int>& group, bool transposed, GroupGradient<Real>& gradient,
                        ParallelErrors& errors) {
  const Cells<Real>& cells = *system.cells;
  const std::size_t n = cells.size();
#pragma omp single
  errors.run([&] {
    gradient.source.resize(n);
    gradient.rest.resize(system.thermal ? n : 0);
    for (auto& axis : gradient.axis) axis.resize(n + lane_padding);
    for (auto& axis : gradient.transposed) axis.resize(transposed ? n + lane_padding : 0);
  });
  const CellEmission<Real> emission = system.thermal_emission();
  double weights = 0;
  for (const int d : group) weights += system.ordinates.weight[d];
  const std::size_t blocks = (n + block_cells - 1) / block_cells;
#pragma omp for schedule(static)
  for (std::size_t block = 0; block < blocks; ++block) {
    errors.run([&] {
      const std::size_t first = block * block_cells;
      const std::size_t count = std::min(block_cells, n - first);
      Real* __restrict const to = gradient.source.data() + first;
      std::fill_n(to, count, Real(0));
      std::array<Real, block_cells> room{};
      for (const int d : group) {
        const Real weight = static_cast<Real>(system.ordinates.weight[d]);
        const Real* __restrict const from = field.stored_row(d).read(first, count, room.data());
        for (std::size_t c = 0; c < count; ++c) to[c] += weight * from[c];
      }
      if (!system.thermal) return;
      // The mean source rather than its sum, as emission is given.
      const Real mean = static_cast<Real>(1 / weights);
      for (std::size_t c = 0; c < count; ++c) {
        to[c] *= mean;
        gradient.rest[first + c] = to[c] - emission.source[first + c];
      }
    });
  }
#pragma omp for schedule(static)
  for (std::size_t block = 0; block < blocks; ++block) {
    errors.run([&] {
      const std::size_t first = block * block_cells;
      const std::size_t count = std::min(block_cells, n - first);
      Real* const x = gradient.axis[0].data() + first;
      Real* const y = gradient.axis[1].data() + first;
      Real* const z = gradient.axis[2].data() + first;
      if (system.thermal) {
        source_gradient(cells, emission, first, count, gradient.source.data(), gradient.rest.data(), x, y, z);
      } else {
        source_gradient(cells, first, count, gradient.source.data(), x, y, z);
      }
    });
  }
  if (!transposed) return;
#pragma omp for schedule(static)
  for (std::size_t block = 0; block < blocks; ++block) {
    errors.run([&] {
      const std::size_t last = std::min(n, (block + 1) * block_cells);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const Real* __restrict const from = gradient.axis[axis].data();
        Real* __restrict const to = gradient.transposed[axis].data();
        const std::uint32_t* __restrict const cell = cells.transposed[0].cell.data();
        for (std::size_t c = block * block_cells; c < last; ++c) to[c] = from[cell[c]];
      }
    });
  }
}

// Values of cells in the order of a march along x.
template <class Real>
void transpose_cells(const Cells<Real>& cells, const Real* __restrict from, Real* __restrict to) {
  const std::uint32_t* __restrict const cell = cells.transposed[0].cell.data();
  for (std::size_t c = 0; c < cells.size(); ++c) to[c] = from[cell[c]];
}

// Adds such values to those of the cells.
template <class Real>
void add_transposed(const Cells<Real>& cells, const Real* __restrict from, Real* __restrict to) {
  const std::uint32_t* __restrict const cell = cells.transposed[0].cell.data();
  for (std::size_t c = 0; c < cells.size(); ++c) to[cell[c]] += from[c];
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
  const bool along_x = system.paths[d].sideways && system.paths[d].sideways->axis == 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    work.gradient.transposed[axis].resize(along_x ? n + lane_padding : 0);
    if (along_x) transpose_cells(*system.cells, work.gradient.axis[axis].data(), work.gradient.transposed[axis].data());
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

// Contribution of one ordinate's march; summed over ordinates in their order.
struct OrdinateFluxes {
  double out = 0;  // through the top, sum of radiances
  MarchTotals sides;
  std::vector<double> profile;  // [nz+1] by height, sum of radiances
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
    if (path.sideways) {
      put_in_columns(path.along_z.front(), radiance);
      sum_alone = path.upward && path.along_z.back().levels() == 0;
      go_sideways(*path.sideways, gradient, source, radiance, record, sum_alone, totals);
      go_along_z(d, path.along_z.back(), gradient, source, radiance, record, passing, totals);
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
    const bool by_level = mixed_ != nullptr && !system_.paths[d].sideways;
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
      work_.transposed_source.resize(n + lane_padding);
      work_.transposed_mean.assign(n + lane_padding, Real(0));
      transpose_cells(cells, source.data(), work_.transposed_source.data());
      // The axes of a march along x are y, z, x.
      constexpr std::array<std::size_t, 3> axis_of_box{1, 2, 0};
      CellSums<Real> sums{work_.transposed_mean.data(), {}};
      for (std::size_t axis = 0; sums_.keeps_moments() && axis < 3; ++axis) {
        work_.transposed_moment[axis].assign(n + lane_padding, Real(0));
        sums.moment[axis] = work_.transposed_moment[axis].data();
      }
      march_sideways(path, transposed.sheets, transposed.gaps, view_along_x(cells, gradient),
                     work_.transposed_source.data(), planes, sums, work_.sideways);
      add_transposed(cells, work_.transposed_mean.data(), work_.mean.data());
      for (std::size_t axis = 0; sums_.keeps_moments() && axis < 3; ++axis)
        add_transposed(cells, work_.transposed_moment[axis].data(), work_.moment[axis_of_box[axis]].data());
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

// The light that arrives at the ground along the ordinates of all ranks.
template <class Real>
void gather_arriving(const OrdinateShare& share, const OrdinateSet& ordinates, std::size_t columns,
                     std::vector<ArrivingRays<Real>>& arriving) {
  std::vector<std::span<Real>> radiance(arriving.size());
  std::vector<std::array<int, 2>> shift(arriving.size());
  std::vector<std::span<int>> shifts(arriving.size());
  for (std::size_t d = 0; d < arriving.size(); ++d) {
    if (ordinates.direction[d].z() > 0) continue;
    arriving[d].radiance.resize(columns + lane_padding);
    radiance[d] = std::span(arriving[d].radiance).first(columns);
    shift[d] = {arriving[d].shift_x, arriving[d].shift_y};
    shifts[d] = shift[d];
  }
  share.gather_ordinates<Real>(radiance);
  share.gather_ordinates<int>(shifts);
  for (std::size_t d = 0; d < arriving.size(); ++d) {
    if (shifts[d].empty()) continue;
    arriving[d].shift_x = shift[d][0];
    arriving[d].shift_y = shift[d][1];
  }
}

// @param flux [octants / 2][columns] of add_arriving().
void gather_arriving_flux(const OrdinateShare& share, std::size_t columns, std::vector<double>& flux) {
  std::vector<std::span<double>> of_octant;
  for (std::size_t octant = 0; octant < flux.size() / columns; ++octant)
    of_octant.push_back(std::span(flux).subspan(octant * columns, columns));
  share.gather_octants<double>(of_octant);
}

void gather_fluxes(const OrdinateShare& share, std::vector<OrdinateFluxes>& of_ordinate, std::size_t levels) {
  std::vector<double> numbers;
  for (OrdinateFluxes& fluxes : of_ordinate) {
    fluxes.profile.resize(levels);
    numbers.insert(numbers.end(), {fluxes.out, fluxes.sides.entered_sides, fluxes.sides.left_sides});
    numbers.insert(numbers.end(), fluxes.profile.begin(), fluxes.profile.end());
  }
  const std::size_t each = 3 + levels;
  std::vector<std::span<double>> spans;
  for (std::size_t d = 0; d < of_ordinate.size(); ++d) spans.push_back(std::span(numbers).subspan(d * each, each));
  share.gather_ordinates<double>(spans);
  for (std::size_t d = 0; d < of_ordinate.size(); ++d) {
    OrdinateFluxes& fluxes = of_ordinate[d];
    fluxes.out = spans[d][0];
    fluxes.sides.entered_sides = spans[d][1];
    fluxes.sides.left_sides = spans[d][2];
    std::copy(spans[d].begin() + 3, spans[d].end(), fluxes.profile.begin());
  }
}

}  // namespace

template <class Real>
void finish_slopes(const TransportSystem<Real>& system, const OrdinateShare& share, const AngularField<Real>& radiance,
                   LightSlopes<Real>& slopes) {
  share.octants_to_cells(slopes.of_radiance);
  for (Slope<Real>& octant : slopes.of_octant) {
    for (std::vector<Real>& axis : octant) axis = std::vector<Real>(radiance.cells + lane_padding);
  }
  system.slopes->scatter(*system.cells, radiance, slopes);
  share.octants_to_rows(slopes.of_octant);
  slopes.fitted = true;
}

template <class Real>
SweepFluxes<Real> sweep(const TransportSystem<Real>& system, AngularField<Real>& field, bool record,
                        SweepWorkspace<Real>& work, LightSlopes<Real>* slopes, const OrdinateShare* share) {
  const BoxGrid& box = system.box;
  const OrdinateSet& ordinates = system.ordinates;
  const std::size_t columns = box.columns();
  const int levels = box.nz() + 1;
  const bool keep_columns = record && system.has_independent_columns();
  std::vector<OrdinateFluxes> of_ordinate(ordinates.size());
  std::vector<ArrivingRays<Real>>& arriving = work.arriving;
  arriving.resize(ordinates.size());
  std::vector<std::vector<Real>> passing(keep_columns ? ordinates.size() : 0);  // [levels * columns] by height
  typename Ground<Real>::Reflection ground;
  work.of_thread.resize(omp_get_max_threads());
  const std::size_t n = system.cells->size();
  const bool mixed = slopes != nullptr && slopes->fitted;
  const bool new_slopes = slopes != nullptr && !slopes->frozen;
  if (new_slopes && share != nullptr) slopes->of_radiance = {};
  if (new_slopes) {
    for (auto& axis : work.moment) axis.resize(n + lane_padding);
  }
  if (mixed) work.gradient = {};
  const bool adds_at_once = system.ground.is_lambertian();
  std::vector<double> arriving_flux(octants / 2 * columns, 0.);
  ArrivingSum<Real> arriving_sum(ordinates, box, arriving_flux);

  const auto march_ordinates = [&](bool upward) {
    const bool shared = !mixed && shares_gradients(system);
    auto groups = groups_side_by_side(system, slopes != nullptr || shared, upward);
    if (share != nullptr) {
      for (std::vector<int>& group : groups) std::erase_if(group, [share](int d) { return !share->has(d); });
      std::erase_if(groups, [](const std::vector<int>& group) { return group.empty(); });
    }
    ParallelErrors errors;
#pragma omp parallel
    {
      typename SweepWorkspace<Real>::Thread& own = work.of_thread[omp_get_thread_num()];
      OrdinateMarch<Real> march(system, mixed ? slopes : nullptr, own);
      for (const std::vector<int>& group : groups) {
        const bool transposed = std::any_of(group.begin(), group.end(), [&](int d) {
          return system.paths[d].sideways && system.paths[d].sideways->axis == 0;
        });
#pragma omp single
        arriving_sum.start(group);
        if (shared) team_make_gradient(system, field, group, transposed, work.gradient, errors);
        const auto march_one = [&](std::size_t q) {
          errors.run([&] {
            const int d = group[q];
            ArrivingRays<Real>& landing = upward || adds_at_once ? own.rays : arriving[d];
            std::vector<Real>& rays = landing.radiance;
            if (upward) {
              const Real* const start_of_rays = ground.leaving.row(system.ground.leaving_row(d));
              rays.assign(start_of_rays, start_of_rays + columns);
              rays.resize(columns + lane_padding);
            } else {
              rays.assign(columns + lane_padding, static_cast<Real>(system.sky_radiance));
            }
            if (keep_columns) passing[d].resize(columns * levels);
            if (field.packed()) {
              own.unpacked.resize(n + lane_padding);
              field.stored_row(d).read(0, n, own.unpacked.data());
            }
            std::vector<Real>& source = field.packed() ? own.unpacked : field.data[d];
            if (mixed && system.paths[d].sideways) {
              mix_slopes_of_ordinate(system, *slopes, d, source.data(), own);
            } else if (!mixed && system.linear_source && !shared) {
              gradient_of_ordinate(system, source.data(), own);
            }
            march.cross_box(d, shared ? work.gradient : own.gradient, source, landing, record, new_slopes,
                            keep_columns ? passing[d].data() : nullptr, of_ordinate[d]);
            if (!upward && adds_at_once) arriving_sum.add(q, own.rays);
            if (field.packed()) field.store(d, 0, n, source.data());
          });
        };
        if (!new_slopes) {
#pragma omp for schedule(dynamic, 1)
          for (std::size_t q = 0; q < group.size(); ++q) march_one(q);
          continue;
        }
        // Moments are added in the order of the ordinates, whichever threads march them.
#pragma omp for schedule(dynamic, 1) ordered
        for (std::size_t q = 0; q < group.size(); ++q) {
          march_one(q);
#pragma omp ordered
          errors.run([&] {
            const Real weight = static_cast<Real>(ordinates.weight[group[q]]);
            for (std::size_t axis = 0; axis < 3; ++axis) {
              const Real* __restrict const from = own.moment[axis].data();
              Real* __restrict const to = work.moment[axis].data();
              if (q == 0) {
                for (std::size_t c = 0; c < n; ++c) to[c] = weight * from[c];
              } else {
                for (std::size_t c = 0; c < n; ++c) to[c] += weight * from[c];
              }
            }
          });
        }
        const int octant = octant_of(ordinates.direction[group.front()]);
#pragma omp single
        errors.run([&] {
          for (auto& axis : slopes->of_radiance[octant]) axis.resize(n + lane_padding);
        });
        system.slopes->team_fit(system.cells->rows, octant, work.moment, slopes->of_radiance[octant]);
      }
    }
    errors.rethrow();
  };

  SweepFluxes<Real> fluxes;
  march_ordinates(false);
  for (int d = 0; !adds_at_once && d < ordinates.size(); ++d) {
    if (!arriving[d].radiance.empty()) add_arriving(arriving[d], ordinates, d, box, arriving_flux);
  }
  if (share != nullptr) {
    gather_arriving_flux(*share, columns, arriving_flux);
    if (!adds_at_once) gather_arriving(*share, ordinates, columns, arriving);
  }
  ground = system.ground.reflect(arriving, arriving_flux, system.beam.surface_flux, ordinates, box);
  fluxes.surface_flux = ground.flux;
  fluxes.surface_absorbed = ground.absorbed;
  if (record && !system.ground.is_lambertian()) {
    for (const ArrivingRays<Real>& rays : arriving)
      fluxes.surface_arriving.push_back(rays.radiance.empty() ? std::vector<Real>() : rays.by_column(box));
  }
  march_ordinates(true);
  if (share != nullptr) {
    gather_fluxes(*share, of_ordinate, record ? static_cast<std::size_t>(levels) : 0);
  } else if (new_slopes) {
    system.slopes->scatter(*system.cells, field, *slopes);
    slopes->fitted = true;
  }

  if (record) {
    fluxes.profile_up.assign(levels, 0.);
    fluxes.profile_down.assign(levels, 0.);
  }
  if (keep_columns) {
    fluxes.column_up.assign(columns * levels, 0.);
    fluxes.column_down.assign(columns * levels, 0.);
  }
  for (int d = 0; d < ordinates.size(); ++d) {
    const bool upward = ordinates.direction[d].z() > 0;
    const double power = ordinates.weight[d] * std::abs(ordinates.direction[d].z());
    const double per_column = power / static_cast<double>(columns);
    if (upward) fluxes.up_top += per_column * of_ordinate[d].out;
    fluxes.side_gain += per_column * of_ordinate[d].sides.entered_sides;
    fluxes.side_loss += per_column * of_ordinate[d].sides.left_sides;
    if (record) {
      std::vector<double>& profile = upward ? fluxes.profile_up : fluxes.profile_down;
      for (int e = 0; e < levels; ++e) profile[e] += per_column * of_ordinate[d].profile[e];
    }
    if (keep_columns) {
      std::vector<double>& column = upward ? fluxes.column_up : fluxes.column_down;
      for (std::size_t m = 0; m < column.size(); ++m) column[m] += power * static_cast<double>(passing[d][m]);
    }
  }
  return fluxes;
}

#define CLOUDBOW_INSTANTIATE(Real)                                                                                 \
  template SweepFluxes<Real> sweep<Real>(const TransportSystem<Real>&, AngularField<Real>&, bool,                  \
                                         SweepWorkspace<Real>&, LightSlopes<Real>*, const OrdinateShare*);         \
  template void finish_slopes<Real>(const TransportSystem<Real>&, const OrdinateShare&, const AngularField<Real>&, \
                                    LightSlopes<Real>&)
CLOUDBOW_INSTANTIATE(float);
CLOUDBOW_INSTANTIATE(double);
#undef CLOUDBOW_INSTANTIATE

}  // namespace cloudbow
