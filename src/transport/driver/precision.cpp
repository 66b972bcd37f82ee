#include "transport/driver/precision.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "cloudbow/sphere/ordinate_set.hpp"

namespace cloudbow {
namespace {

// Rounding acts like a source of light in every cell. In a thick medium that hardly absorbs, such light needs as many
// scatterings to leave as the sun's. In a very thick cell the radiance differs from its source by less than float
// resolves. These fields converge in double alone. Measured on conservative slabs: optical depth 100 is fine in float,
// 200 is not; cells of optical depth 25 in absorbing air are fine, 250 are not.
constexpr double thickest_cell_in_float = 50;
constexpr double thickest_domain_in_float = 120;
// A cell's net power is a small difference of what it absorbs and what it emits: beyond this optical depth for
// absorption, float leaves more than 1e-5 of the Planck flux.
constexpr double most_emitting_in_float = 10;
// Of 12 thick clouds, 9 are at estimated errors of 4e-6 to 1.1e-5 after 30 sweeps in float, and hardly improve. In
// double these come below 1e-6 within 15 to 28 sweeps. Media of less optical depth than this were not measured (mean
// over the columns, each weighted with its own).
constexpr double finest_tolerance_in_float = 5e-6;
constexpr double thickest_domain_for_it = 5;
// Radiances for which double takes 2 GB more than float.
constexpr double most_values_in_double = 5e8;

}  // namespace

bool too_thick_for_float(const OpticalGrid& grid) {
  const BoxGrid& box = grid.box;
  double optical_depth = 0;  // summed over the columns
  double absorbing = 0;      // of it
  double thickest = 0;
  double most_emitting = 0;
  grid.for_each_cell([&](int k, std::size_t c, std::uint32_t voxels) {
    const double thickness = box.thickness_m(k);
    const double edge = std::min({thickness, box.nx > 1 ? box.dx_m : thickness, box.ny > 1 ? box.dy_m : thickness});
    const double extinction = grid.extinction(c);
    optical_depth += voxels * extinction * thickness;
    absorbing += voxels * static_cast<double>(grid.absorption[c]) * thickness;
    // Blocks of air are wider than a voxel, and their light is soon that of their own level.
    const AirBlocks air = grid.air_of(k);
    if (air.count() > 0 && c >= air.first_cell) return;
    thickest = std::max(thickest, extinction * edge);
    if (grid.emits()) most_emitting = std::max(most_emitting, static_cast<double>(grid.absorption[c]) * edge);
  });
  if (thickest > thickest_cell_in_float || most_emitting > most_emitting_in_float) return true;
  // Light comes no deeper than the diffusion length, here with isotropic scattering, which is short.
  const double diffusion_length = absorbing > 0 ? std::sqrt(optical_depth / (3 * absorbing)) : HUGE_VAL;
  const double mean_depth = optical_depth / static_cast<double>(box.columns());
  return std::min(mean_depth, 3 * diffusion_length) > thickest_domain_in_float;
}

bool tolerance_needs_double(const OpticalGrid& grid, std::size_t cells, const SolverOptions& options) {
  if (options.tolerance >= finest_tolerance_in_float || options.half_precision_radiance) return false;
  const double ordinates = make_ordinate_set(options.directions).size();
  if (static_cast<double>(cells) * ordinates > most_values_in_double) return false;
  std::vector<double> depth(grid.box.columns(), 0.);
  grid.for_each_place([&](int k, std::size_t column, std::size_t cell) {
    depth[column] += grid.extinction(cell) * grid.box.thickness_m(k);
  });
  double sum = 0, weighted = 0;
  for (const double d : depth) {
    sum += d;
    weighted += d * d;
  }
  return weighted > thickest_domain_for_it * sum;
}

}  // namespace cloudbow
