// Emission: Planck's law, enclosures, emissivity.
#include <cmath>
#include <limits>
#include <numbers>

#include "app/verify/checks.hpp"
#include "app/verify/scenes.hpp"
#include "cloudbow/medium/emission.hpp"
#include "cloudbow/optics/planck.hpp"
#include "cloudbow/transport/solver.hpp"

namespace cloudbow {
namespace {

constexpr double stefan_boltzmann = 5.670374419e-8;  // W m-2 K-4, exact in the SI of 2019 to these digits

double planck_total() {
  const PlanckFunction all = PlanckFunction::over({1e-3, std::numeric_limits<double>::infinity()});
  Worst worst;
  for (const double kelvin : {3., 180., 288.2, 5800.})
    worst.meet(pi * all(kelvin) / (stefan_boltzmann * std::pow(kelvin, 4)), 1);
  return worst.value();
}

double brightness_temperature() {
  Worst worst;
  for (const double kelvin : {150., 220., 288.2, 340.}) {
    for (const PlanckFunction& planck :
         {PlanckFunction::at(3.7), PlanckFunction::at(10.8), PlanckFunction::over({8, 12})})
      worst.meet(planck.brightness_temperature(planck(kelvin)), kelvin);
  }
  return worst.value();
}

/// All matter and the ground emit as a black body of one temperature, of which the Planck radiance is 1.
void warm(Problem& problem) {
  problem.sun.reset();
  set_emission(
      problem.grid, [](double) { return 1.; }, [](double) { return 1.; });
  problem.surface.planck = 1;
}

// In an enclosure of one temperature radiance is that of a black body everywhere, whatever scatters and reflects.
double enclosure() {
  Worst worst;
  const auto meet = [&worst](const Solution& solution) {
    for (const auto* profile : {&solution.profile_upwelling_flux, &solution.profile_downwelling_diffuse_flux})
      for (const double flux : *profile) worst.meet(flux / pi, 1);
  };
  for (const bool periodic : {true, false}) {
    Problem field = field_problem(uneven_field(6, 5, 4, 4), .6, PhaseFunction::isotropic(), {}, periodic);
    field.surface.albedo = .3;
    field.sky_radiance = 1;
    warm(field);
    SolverOptions options = field_options();
    options.tolerance = 1e-5;
    meet(solve(field, options));
  }
  Problem layer = layer_problem(8, .9, PhaseFunction::henyey_greenstein(.85), 1);
  layer.surface.albedo = .3;
  layer.sky_radiance = 1;
  warm(layer);
  SolverOptions options = column_options();
  options.independent_columns = true;
  meet(solve(layer, options));
  return worst.value();
}

// Exponential integral E3 by Simpson's rule: int exp(-t / mu) mu dmu from 0 to 1.
double exponential_integral_3(double t) {
  constexpr int steps = 20000;
  const auto value = [t](double mu) { return mu > 0 ? std::exp(-t / mu) * mu : 0; };
  double sum = value(0) + value(1);
  for (int n = 1; n < steps; ++n) sum += (n % 2 == 1 ? 4 : 2) * value(static_cast<double>(n) / steps);
  return sum / steps / 3;
}

// An isothermal slab that absorbs alone, above a ground that neither emits nor reflects.
double emissivity() {
  Worst worst;
  for (const double tau : {.1, 1., 10.}) {
    Problem problem = layer_problem(tau, 0, PhaseFunction::isotropic(), 1);
    warm(problem);
    problem.surface.planck = 0;
    SolverOptions options = column_options();
    options.independent_columns = true;
    const Solution solution = solve(problem, options);
    const double wanted = pi * (1 - 2 * exponential_integral_3(tau));
    worst.meet(solution.profile_upwelling_flux.back() / wanted, 1);
    worst.meet(solution.profile_downwelling_diffuse_flux.front() / wanted, 1);
  }
  return worst.value();
}

}  // namespace

std::vector<PhysicalCheck> thermal_checks() {
  return {
      // The constant has ten digits, the sum of the series more.
      {"planck-total", "the Planck function over all wavelengths is sigma T^4 / pi", "of it", 1e-9, planck_total},
      {"brightness-temperature", "the temperature of a black body's radiance is that of the body", "K", 1e-6,
       brightness_temperature},
      // Eight directions per hemisphere.
      {"emissivity", "an isothermal slab that absorbs alone has the emissivity 1 - 2 E3(tau)", "of it", 2e-4,
       emissivity},
      // The iteration's tolerance of 1e-5, and slopes of light in uneven clouds, as furnace-radiance.
      {"enclosure", "if all has one temperature, fluxes are those of a black body", "of it", 2e-4, enclosure},
  };
}

}  // namespace cloudbow
