#include "cloudbow/medium/emission.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "cloudbow/core/parallel_errors.hpp"
#include "row_cursor.hpp"

namespace cloudbow {
namespace {

using Function = std::function<double(double)>;

/// B of a cell.
struct Emission {
  double mean = 0;
  double step = 0;
};

/// @param temperature at a height of the cell
template <class Temperature>
Emission emission_between(double bottom_m, double top_m, const Temperature& temperature, const Function& planck) {
  const double bottom = planck(temperature(bottom_m)), top = planck(temperature(top_m));
  const double middle = planck(temperature((bottom_m + top_m) / 2));
  const double mean = (bottom + 4 * middle + top) / 6;
  // B is so curved in a cell with one very cold face that its chord could become negative.
  return {mean, std::clamp(top - bottom, -2 * mean, 2 * mean)};
}

/// Rows of the cloud in and around those of the grid.
class VoxelsOfCells {
 public:
  VoxelsOfCells(const BoxGrid& box, const CloudField& cloud, const VoxelTemperatures& kelvin, const Function& air,
                const Function& planck)
      : cloud_(cloud),
        kelvin_(kelvin),
        air_(air),
        planck_(planck),
        first_i_(static_cast<int>(std::lround((cloud.min_m[0] - box.x_min_m) / box.dx_m))),
        first_j_(static_cast<int>(std::lround((cloud.min_m[1] - box.y_min_m) / box.dy_m))) {}

  /// Calls use(cell, emission) for those cells of a row that are in a voxel.
  template <class Use>
  void for_each(const OpticalGrid& grid, int level, int j, const Use& use) const {
    const double bottom = grid.box.z_edge_m[level], top = grid.box.z_edge_m[level + 1];
    const double dz = cloud_.cell_size_m[2];
    const double plane = std::floor(((bottom + top) / 2 - cloud_.min_m[2]) / dz);
    if (!(plane >= 0 && plane < cloud_.cells[2])) return;
    const int k = static_cast<int>(plane), row = j - first_j_;
    RowCursor here(cloud_, k, row), above(cloud_, k + 1, row), below(cloud_, k - 1, row);
    const double centre = cloud_.min_m[2] + (k + .5) * dz;
    const double slope_of_air = (air_(centre + dz / 2) - air_(centre - dz / 2)) / dz;
    for (const RowSpan& span : grid.row(level, j)) {
      for (int n = 0; n < span.n; ++n) {
        const int i = span.i + n - first_i_;
        const auto voxel = here.voxel(i);
        if (!voxel) continue;
        const double kelvin = kelvin_[*voxel];
        const auto higher = above.voxel(i), lower = below.voxel(i);
        const double kelvin_above = higher ? kelvin_[*higher] : kelvin, kelvin_below = lower ? kelvin_[*lower] : kelvin;
        const int steps = (higher ? 1 : 0) + (lower ? 1 : 0);
        const double slope = steps > 0 ? (kelvin_above - kelvin_below) / (steps * dz) : slope_of_air;
        const auto temperature = [&](double z) { return std::max(0., kelvin + slope * (z - centre)); };
        use(span.offset + static_cast<std::size_t>(n), emission_between(bottom, top, temperature, planck_));
      }
    }
  }

 private:
  const CloudField& cloud_;
  const VoxelTemperatures& kelvin_;
  const Function& air_;
  const Function& planck_;
  int first_i_;  // column of the grid that is the cloud's first
  int first_j_;
};

/// The radiance between two heights, on points so close that it is linear between them.
struct RadianceProfile {
  std::vector<double> height_m;
  std::vector<double> radiance;
};

RadianceProfile sample(const Atmosphere& atmosphere, const Function& planck, double bottom_m, double top_m,
                       double tolerance) {
  std::vector<double> kinks{bottom_m};
  for (const double z : atmosphere.height_m) {
    if (z > bottom_m && z < top_m) kinks.push_back(z);
  }
  kinks.push_back(top_m);
  const auto at = [&](double z) { return planck(atmosphere.temperature_at(z)); };
  double largest = 0;
  for (const double z : kinks) largest = std::max(largest, at(z));
  RadianceProfile profile{{bottom_m}, {at(bottom_m)}};
  for (std::size_t n = 0; n + 1 < kinks.size(); ++n) {
    const double low = kinks[n], thickness = kinks[n + 1] - low;
    const double departure = std::abs(at(low + thickness / 2) - (at(low) + at(kinks[n + 1])) / 2);
    constexpr double fewest = 8, most = 10000;
    constexpr double fineness = 5;  // departures between points are 1/25 of the tolerance
    const double wanted = largest > 0 ? fineness * std::sqrt(departure / (tolerance * largest)) : 0;
    const int points = static_cast<int>(std::clamp(std::ceil(wanted), fewest, most));
    for (int point = 1; point <= points; ++point) {
      const double z = point == points ? kinks[n + 1] : low + thickness * point / points;
      profile.height_m.push_back(z);
      profile.radiance.push_back(at(z));
    }
  }
  return profile;
}

bool is_linear(const RadianceProfile& of, std::size_t first, std::size_t last, double allowed) {
  const double slope = (of.radiance[last] - of.radiance[first]) / (of.height_m[last] - of.height_m[first]);
  for (std::size_t n = first + 1; n < last; ++n) {
    const double chord = of.radiance[first] + slope * (of.height_m[n] - of.height_m[first]);
    if (std::abs(of.radiance[n] - chord) > allowed) return false;
  }
  return true;
}

}  // namespace

void set_emission(OpticalGrid& grid, const Function& air, const Function& planck, const CloudField* cloud,
                  const VoxelTemperatures* temperatures) {
  const BoxGrid& box = grid.box;
  const auto levels = static_cast<std::size_t>(box.nz());
  grid.planck.assign(grid.active_cells(), 0.F);
  grid.planck_step.assign(grid.active_cells(), 0.F);
  grid.layer_planck.assign(levels, 0.);
  grid.layer_planck_step.assign(levels, 0.);
  const auto set = [&grid](std::size_t cell, const Emission& of) {
    grid.planck[cell] = static_cast<float>(of.mean);
    grid.planck_step[cell] = static_cast<float>(of.step);
  };
  for (int k = 0; k < box.nz(); ++k) {
    const Emission of_air = emission_between(box.z_edge_m[k], box.z_edge_m[k + 1], air, planck);
    grid.layer_planck[k] = of_air.mean;
    grid.layer_planck_step[k] = of_air.step;
    for (std::size_t cell = grid.first_cell(k); cell < grid.first_cell(k + 1); ++cell) set(cell, of_air);
  }
  if (cloud == nullptr || temperatures == nullptr) return;
  assert(temperatures->size() == cloud->active_voxels());
  const VoxelsOfCells voxels(box, *cloud, *temperatures, air, planck);
  const int rows = box.nz() * box.ny;
  ParallelErrors errors;
#pragma omp parallel for schedule(dynamic, 16)
  for (int row = 0; row < rows; ++row) errors.run([&] { voxels.for_each(grid, row / box.ny, row % box.ny, set); });
  errors.rethrow();
}

std::vector<double> heights_where_planck_is_linear(const Atmosphere& atmosphere, const Function& planck,
                                                   double bottom_m, double top_m, double tolerance) {
  assert(top_m > bottom_m && tolerance > 0);
  const RadianceProfile profile = sample(atmosphere, planck, bottom_m, top_m, tolerance);
  constexpr double between_points = .9;  // leaves room for departures between the points
  const double allowed =
      between_points * tolerance * *std::max_element(profile.radiance.begin(), profile.radiance.end());
  std::vector<double> heights;
  for (std::size_t first = 0, last = 1; last < profile.height_m.size(); ++last) {
    if (last == first + 1 || is_linear(profile, first, last, allowed)) continue;
    first = last - 1;
    heights.push_back(profile.height_m[first]);
  }
  return heights;
}

}  // namespace cloudbow
