#include "transport/problem/power.hpp"

#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

namespace cloudbow {
namespace {

constexpr double pi = std::numbers::pi;

}  // namespace

double incident_power(const Problem& problem) {
  const double mu0 = problem.sun ? -problem.sun->travel.z() : 1;
  return (problem.sun ? mu0 * problem.sun->irradiance : 0) + pi * problem.sky_radiance;
}

double ground_emission(const Problem& problem) {
  const Surface& surface = problem.surface;
  if (!surface.emits()) return 0;
  const bool map_of_albedo = !surface.brdf && !surface.albedo_map.empty();
  const auto emitted = [&](std::size_t column) {
    const double albedo = map_of_albedo ? static_cast<double>(surface.albedo_map[column]) : surface.albedo;
    const double planck = surface.planck_map.empty() ? surface.planck : static_cast<double>(surface.planck_map[column]);
    return surface.brdf ? planck : (1 - albedo) * planck;
  };
  const std::size_t columns = map_of_albedo || !surface.planck_map.empty() ? problem.grid.box.columns() : 1;
  double sum = 0;
  for (std::size_t c = 0; c < columns; ++c) sum += emitted(c);
  return pi * sum / static_cast<double>(columns);
}

double matter_emission(const Problem& problem) {
  const OpticalGrid& grid = problem.grid;
  if (!grid.emits()) return 0;
  constexpr double diffusivity = 5. / 3;
  const std::size_t columns = grid.box.columns();
  // From the bottom up: radiance upwards at the cell's top, and transmission from the ground to its bottom.
  std::vector<double> up(columns, 0.), transmission(columns, 1.);
  double down = 0;
  grid.for_each_place([&](int k, std::size_t column, std::size_t cell) {
    const double path = diffusivity * static_cast<double>(grid.absorption[cell]) * grid.box.thickness_m(k);
    const double emitted = static_cast<double>(grid.planck[cell]) * -std::expm1(-path);
    down += emitted * transmission[column];
    up[column] = up[column] * std::exp(-path) + emitted;
    transmission[column] *= std::exp(-path);
  });
  return pi * std::accumulate(up.begin(), up.end(), down) / static_cast<double>(columns);
}

}  // namespace cloudbow
