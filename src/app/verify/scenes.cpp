#include "app/verify/scenes.hpp"

#include <cmath>
#include <numbers>

#include "app/scene/accuracy.hpp"
#include "cloudbow/sphere/travel.hpp"

namespace cloudbow {
namespace {

double zenith_deg(double mu) { return std::acos(mu) * 180 / std::numbers::pi; }

// Multiples of irrational numbers modulo 1 are spread evenly and without order.
double fraction(double x) { return x - std::floor(x); }

SolverOptions without_cache(SolverOptions options) {
  options.fit.cache_directory.clear();
  options.threads = 1;
  return options;
}

}  // namespace

SceneSun sun_at(double mu0, double azimuth_deg) { return {zenith_deg(mu0), azimuth_deg, 1}; }

Direction beam_travel(double mu0, double azimuth_deg) { return travel_from(zenith_deg(mu0), azimuth_deg); }

Direction travel_to_sensor(double mu, double azimuth_deg) { return -travel_from(zenith_deg(mu), azimuth_deg); }

PhaseFunction droplets() { return PhaseFunction::henyey_greenstein(.85); }

Problem layer_problem(double optical_depth, double single_scattering_albedo, const PhaseFunction& phase, double mu0,
                      double azimuth_deg) {
  const Layer layer{0, 1000, optical_depth, single_scattering_albedo, 0};
  Problem problem;
  problem.grid =
      make_optical_grid(nullptr, {}, {layer}, {0, 0, 0}, {1, 1, 1000}, true, 1, {0.}, LevelOptions::layers_only());
  problem.phase = {phase};
  problem.sun = Sun{beam_travel(mu0, azimuth_deg), 1};
  return problem;
}

ExtinctionField uneven_field(int nx, int ny, int nz, double largest) {
  ExtinctionField field{nx, ny, nz, {}, {1, 1, 1}};
  const std::size_t cells = field.columns() * static_cast<std::size_t>(nz);
  for (std::size_t n = 1; n <= cells; ++n) {
    const bool empty = fraction(static_cast<double>(n) * std::sqrt(3.)) < 1. / 3;
    field.extinction.push_back(empty ? 0.F
                                     : static_cast<float>(largest * fraction(static_cast<double>(n) * std::sqrt(2.))));
  }
  return field;
}

Problem field_problem(const ExtinctionField& field, double single_scattering_albedo, const PhaseFunction& phase,
                      const SceneSun& sun, bool periodic) {
  const CloudField cloud =
      make_cloud_field({field.nx, field.ny, field.nz}, field.cell_m, {0, 0, 0}, field.extinction, "extinction");
  CloudOptics optics;
  optics.single_scattering_albedo = single_scattering_albedo;
  LevelOptions levels;  // those of all cells, empty ones too
  for (int k = 0; k <= field.nz; ++k) levels.edges_m.push_back(k * field.cell_m[2]);
  Problem problem;
  problem.grid = make_optical_grid(&cloud, optics, {}, {0, 0, 0}, {cloud.max_m(0), cloud.max_m(1), cloud.max_m(2)},
                                   periodic, 1, {0.}, levels);
  problem.phase = {phase};
  problem.sun = Sun{travel_from(sun.zenith_deg, sun.azimuth_deg), sun.irradiance_w_m2};
  return problem;
}

SolverOptions column_options(const char* accuracy) {
  return without_cache(accuracy_options(accuracy, HorizontalExtent::column, false));
}

SolverOptions field_options(const char* accuracy) {
  return without_cache(accuracy_options(accuracy, HorizontalExtent::field, false));
}

}  // namespace cloudbow
