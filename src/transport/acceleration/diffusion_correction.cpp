#include "transport/acceleration/diffusion_correction.hpp"

#include <algorithm>
#include <cmath>

#include "transport/rays/ray_rows.hpp"

namespace cloudbow {
namespace {

// Least optical depth for transport scattering along longest_free_path() of levels and columns in which light diffuses.
constexpr double least_to_diffuse = .1;
// Columns beside those, which are part of the problem as well.
constexpr int columns_beside = 2;
// Optical depth of a cell beyond which its current is not corrected: light hardly crosses it within a sweep, and the
// correction would overshoot.
constexpr double thick_for_currents = 50;
// A lower tolerance does not reduce the number of sweeps, unless the medium is very thick. Conservative slabs of
// transport optical depth 7.5 take as many with .1 as with .02. Those of 15 take twice as many with .1, or stall.
constexpr double usual_tolerance = .1;
constexpr double tolerance_if_thick = .02;
constexpr double thick_transport_depth = 10;

// Part of the extinction of a cell that scatters light out of its direction, 1/m.
template <class Real>
double transport_scattering(const TransportSystem<Real>& system, std::size_t cell) {
  double share = 0;
  for (std::size_t p = 0; p < system.cells->scattered.size(); ++p)
    share += static_cast<double>(system.cells->scattered[p][cell]) * (1 - system.truncated_asymmetry[p]);
  return share * static_cast<double>(system.cells->extinction[cell]);
}

// From the lowest to the highest level in which light diffuses. Above and below them light leaves freely. Diffusivity
// has a limit: in the box of the diffusion problem such levels would scatter light back, and the iteration diverges.
template <class Real>
LevelRange diffusing_levels(const TransportSystem<Real>& system) {
  const BoxGrid& box = system.box;
  const std::vector<std::uint32_t>& level_cell = system.cells->rows.level_cell;
  std::vector<double> most(box.nz(), 0.);
  for (int k = 0; k < box.nz(); ++k)
    for (std::size_t c = level_cell[k]; c < level_cell[k + 1]; ++c)
      most[k] = std::max(most[k], transport_scattering(system, c));
  // Without levels that count, the range stays.
  const auto trimmed = [](LevelRange levels, const auto& counts) {
    LevelRange inner = levels;
    while (inner.first < inner.last && !counts(inner.first)) ++inner.first;
    while (inner.first < inner.last && !counts(inner.last - 1)) --inner.last;
    return inner.first < inner.last ? inner : levels;
  };
  LevelRange levels = trimmed({0, box.nz()}, [&](int k) { return most[k] > 0; });
  for (int before = 0; before != levels.last - levels.first;) {
    before = levels.last - levels.first;
    const double depth = box.z_edge_m[levels.last] - box.z_edge_m[levels.first];
    levels = trimmed(levels, [&](int k) { return most[k] * longest_free_path(box, k, depth) >= least_to_diffuse; });
  }
  return levels;
}

BoxGrid box_of(const BoxGrid& all, const LevelRange& levels) {
  BoxGrid box = all;
  box.z_edge_m.assign(all.z_edge_m.begin() + levels.first, all.z_edge_m.begin() + levels.last + 1);
  return box;
}

// Calls use(cell, column, k) for voxels with matter in these levels, counted from 0.
template <class Use>
void for_each_voxel(const ActiveRows& rows, const LevelRange& levels, const Use& use) {
  const std::size_t columns = static_cast<std::size_t>(rows.nx) * static_cast<std::size_t>(rows.ny);
  for_each_place(rows, [&](std::uint32_t cell, std::size_t place) {
    const int k = static_cast<int>(place / columns);
    if (k >= levels.first && k < levels.last) use(cell, place % columns, k - levels.first);
  });
}

// Marks what lies at most columns_beside from marked places.
void spread(std::vector<char>& marked, const BoxGrid& box) {
  const auto along = [&](int count, int stride, int rows, int row_stride) {
    const std::vector<char> from = marked;
    for (int row = 0; row < rows; ++row) {
      for (int i = 0; i < count; ++i) {
        if (from[row * row_stride + i * stride] == 0) continue;
        for (int to = i - columns_beside; to <= i + columns_beside; ++to) {
          const int inside = box.periodic ? wrapped(to, count) : std::clamp(to, 0, count - 1);
          marked[row * row_stride + inside * stride] = 1;
        }
      }
    }
  };
  along(box.nx, 1, box.ny, box.nx);
  along(box.ny, box.nx, box.nx, 1);
}

// Those in which light diffuses, and those beside them: empty columns need not be solved for.
// @param box of the levels.
template <class Real>
ColumnSet diffusing_columns(const TransportSystem<Real>& system, const LevelRange& levels, const BoxGrid& box) {
  const double depth = box.z_edge_m.back() - box.z_edge_m.front();
  std::vector<char> marked(box.columns(), 0);
  for_each_voxel(system.cells->rows, levels, [&](std::uint32_t cell, std::size_t column, int k) {
    if (transport_scattering(system, cell) * longest_free_path(box, k, depth) >= least_to_diffuse) marked[column] = 1;
  });
  spread(marked, box);
  std::vector<std::uint32_t> places;
  for (std::uint32_t c = 0; c < marked.size(); ++c) {
    if (marked[c] != 0) places.push_back(c);
  }
  return places.empty() ? ColumnSet::of(box) : ColumnSet(box.nx, box.ny, box.periodic, std::move(places));
}

template <class Real>
DiffusionOperator diffusion_in(const TransportSystem<Real>& system, const LevelRange& levels, const BoxGrid& box) {
  ColumnSet columns = diffusing_columns(system, levels, box);
  const auto nz = static_cast<std::size_t>(box.nz());
  const std::size_t places = columns.size() * nz;
  const std::vector<std::uint32_t> column_at = columns.by_place();
  DiffusionCoefficients given;
  given.extinction.assign(places, 0.F);
  given.transport.assign(places, 0.F);
  given.absorption.assign(places, 0.F);
  given.surface_albedo = system.ground.mean_albedo();
  given.independent_columns = system.independent_columns;
  for_each_voxel(system.cells->rows, levels, [&](std::uint32_t cell, std::size_t column, int k) {
    if (column_at[column] == columns.size()) return;
    const std::size_t place = column_at[column] * nz + static_cast<std::size_t>(k);
    const double absorption = static_cast<double>(system.absorption[cell]);
    given.extinction[place] = static_cast<float>(system.cells->extinction[cell]);
    given.transport[place] = static_cast<float>(absorption + transport_scattering(system, cell));
    given.absorption[place] = static_cast<float>(absorption);
  });
  return {box, std::move(columns), given};
}

}  // namespace

template <class Real>
double transport_depth(const TransportSystem<Real>& system) {
  const std::size_t columns = system.box.columns();
  std::vector<double> depth(columns, 0.);
  for_each_place(system.cells->rows, [&](std::uint32_t c, std::size_t place) {
    depth[place % columns] +=
        transport_scattering(system, c) * system.box.thickness_m(static_cast<int>(place / columns));
  });
  double sum = 0, weighted = 0;
  for (const double d : depth) {
    sum += d;
    weighted += d * d;
  }
  return sum > 0 ? weighted / sum : 0;
}

template <class Real>
DiffusionCorrection<Real>::DiffusionCorrection(const TransportSystem<Real>& system)
    : independent_columns_(system.independent_columns),
      all_(system.cells->size()),
      tolerance_(transport_depth(system) < thick_transport_depth ? usual_tolerance : tolerance_if_thick),
      levels_(diffusing_levels(system)),
      box_(box_of(system.box, levels_)),
      operator_(diffusion_in(system, levels_, box_)) {
  const auto nz = static_cast<std::uint32_t>(box_.nz());
  const std::vector<std::uint32_t> column_at = operator_.columns().by_place();
  for_each_voxel(system.cells->rows, levels_, [&](std::uint32_t cell, std::size_t column, int k) {
    if (column_at[column] == operator_.columns().size()) return;
    const double thickness_m = box_.thickness_m(k);
    const double extinction = static_cast<double>(system.cells->extinction[cell]);
    double scattering = 0;
    double forward = 0;
    for (std::size_t p = 0; p < system.cells->scattered.size(); ++p) {
      const double share = static_cast<double>(system.cells->scattered[p][cell]) * extinction;
      scattering += share;
      forward += share * system.truncated_asymmetry[p];
    }
    const double depth = extinction * thickness_m / thick_for_currents;
    Voxel voxel;
    voxel.cell = cell;
    voxel.place = column_at[column] * nz + static_cast<std::uint32_t>(k);
    voxel.share = 1 / system.cells->rows.places_of(cell);
    voxel.power = scattering * box_.dx_m * box_.dy_m * thickness_m;
    voxel.current_share = 1 / (1 + depth * depth);
    voxel.forward = forward * 3 * operator_.free_diffusivity(voxel.place) * voxel.current_share;
    voxels_.push_back(voxel);
  });
}

template <class Real>
void DiffusionCorrection<Real>::correct(std::span<const Real> change, std::span<Real> moments, Workspace& work) const {
  const ColumnSet& columns = operator_.columns();
  const auto nz = static_cast<std::size_t>(box_.nz());
  const std::size_t places = columns.size() * nz;
  std::vector<double>&source = work.source, &correction = work.correction;
  Flow& flow = work.flow;
  source.assign(places, 0.);
  correction.resize(places);
  for (std::vector<float>& along : flow) along.resize(places);  // 0 but in voxels
  for (const Voxel& voxel : voxels_) {
    source[voxel.place] = voxel.power * static_cast<double>(change[voxel.cell]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      flow[axis][voxel.place] = static_cast<float>(
          voxel.forward * static_cast<double>(change[(axis + 1) * all_ + voxel.cell]) / std::sqrt(3.));
  }
  diverge(flow, source);
  operator_.solve(source, correction, tolerance_, work.solve);
  for (const Voxel& voxel : voxels_) {
    const std::size_t at = voxel.place;
    const std::size_t column = at / nz;
    const std::size_t k = at % nz;
    moments[voxel.cell] += static_cast<Real>(voxel.share * correction[at]);
    const double slide = voxel.current_share * operator_.diffusivity(at);
    const auto add = [&](std::size_t axis, double gradient) {
      moments[(axis + 1) * all_ + voxel.cell] +=
          static_cast<Real>(voxel.share * std::sqrt(3.) * (static_cast<double>(flow[axis][at]) - slide * gradient));
    };
    // Columns at the sides are their own neighbours.
    const auto across = [&](ColumnSet::Side high, ColumnSet::Side low, double width) {
      const auto beside = [&](ColumnSet::Side side) {
        const std::size_t other = columns.beside[column][side];
        return correction[other < columns.size() ? other * nz + k : at];
      };
      return (beside(high) - beside(low)) / (2 * width);
    };
    if (!independent_columns_ && box_.nx > 1) add(0, across(ColumnSet::east, ColumnSet::west, box_.dx_m));
    if (!independent_columns_ && box_.ny > 1) add(1, across(ColumnSet::north, ColumnSet::south, box_.dy_m));
    // At the ends about half the flux is left on the face, half a cell away.
    const bool last = k + 1 == nz;
    const double above = last ? correction[at] / 2 : correction[at + 1];
    const double below = k == 0 ? correction[at] / 2 : correction[at - 1];
    const double distance = last || k == 0 ? 1.5 : 2;
    add(2, (above - below) / (distance * box_.thickness_m(static_cast<int>(k))));
  }
}

// source -= divergence of the flow, through faces.
template <class Real>
void DiffusionCorrection<Real>::diverge(const Flow& flow, std::vector<double>& source) const {
  const ColumnSet& columns = operator_.columns();
  const auto nz = static_cast<std::size_t>(box_.nz());
  for (std::size_t column = 0; column < columns.size(); ++column) {
    const auto face = [&](std::size_t axis, std::size_t at, std::size_t other, double area) {
      const double through = (static_cast<double>(flow[axis][at]) + static_cast<double>(flow[axis][other])) / 2 * area;
      source[at] -= through;
      source[other] += through;
    };
    const std::size_t east = columns.beside[column][ColumnSet::east];
    const std::size_t north = columns.beside[column][ColumnSet::north];
    for (std::size_t k = 0; k < nz; ++k) {
      const std::size_t at = column * nz + k;
      const double dz = box_.thickness_m(static_cast<int>(k));
      if (!independent_columns_ && east < columns.size()) face(0, at, east * nz + k, box_.dy_m * dz);
      if (!independent_columns_ && north < columns.size()) face(1, at, north * nz + k, box_.dx_m * dz);
      if (k + 1 < nz) face(2, at, at + 1, box_.dx_m * box_.dy_m);
    }
  }
}

template double transport_depth<float>(const TransportSystem<float>&);
template double transport_depth<double>(const TransportSystem<double>&);
template class DiffusionCorrection<float>;
template class DiffusionCorrection<double>;

}  // namespace cloudbow
