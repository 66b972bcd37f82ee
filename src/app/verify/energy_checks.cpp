// Energy of light: energy ledgers, furnaces, proportion.
#include <cmath>
#include <numbers>
#include <numeric>

#include "app/verify/checks.hpp"
#include "app/verify/scenes.hpp"
#include "cloudbow/transport/solver.hpp"

namespace cloudbow {
namespace {

constexpr double sun_cosine = .6;

Problem uneven_problem(double single_scattering_albedo, double surface_albedo, bool periodic = true) {
  Problem problem =
      field_problem(uneven_field(6, 5, 4, 4), single_scattering_albedo, droplets(), sun_at(sun_cosine, 37), periodic);
  problem.surface.albedo = surface_albedo;
  return problem;
}

double mean_of_level(const std::vector<float>& flux, std::size_t level, std::size_t columns) {
  const auto first = flux.begin() + static_cast<std::ptrdiff_t>(level * columns);
  return std::accumulate(first, first + static_cast<std::ptrdiff_t>(columns), 0.) / static_cast<double>(columns);
}

// Without absorption in the medium, light leaves through the top or is absorbed by the ground: by the energy ledger and
// by the fluxes.
double conservation(const Solution& solution, double surface_albedo) {
  const EnergyLedger& ledger = solution.ledger;
  const double absorbed = (1 - surface_albedo) * ledger.transmittance;
  Worst worst;
  worst.meet(ledger.residual);
  worst.meet(ledger.reflectance + absorbed, 1);
  worst.meet(ledger.absorptance);
  worst.meet(ledger.surface_absorptance, absorbed);
  const std::size_t columns = solution.box.columns();
  const std::size_t top = solution.flux_level.size() - 1;
  worst.meet(mean_of_level(solution.upwelling_flux, top, columns) / sun_cosine, ledger.reflectance);
  return worst.value();
}

double column_energy() {
  Worst worst;
  for (const double surface : {0., .3}) {
    Problem problem = layer_problem(8, 1, droplets(), sun_cosine);
    problem.surface.albedo = surface;
    worst.meet(conservation(solve(problem, column_options("draft")), surface));
  }
  return worst.value();
}

double field_energy() {
  Worst worst;
  for (const double surface : {0., .3})
    worst.meet(conservation(solve(uneven_problem(1, surface), field_options()), surface));
  return worst.value();
}

double open_energy() { return std::abs(solve(uneven_problem(1, .3, false), field_options()).ledger.residual); }

// The beam comes in through the sunlit sides, 5 m and 6 m wide and 4 m high. Their areas are projected towards the sun.
double beam_through_sides() {
  const Direction sun = beam_travel(sun_cosine, 37);
  const double through_sides = 4 * (5 * std::abs(sun.x()) + 6 * std::abs(sun.y())) / (30 * sun_cosine);
  const Solution solution = solve(uneven_problem(1, 0, false), field_options("balanced"));
  return std::abs(solution.ledger.side_gain / through_sides - 1);
}

double absorbed_power() {
  const Solution solution = solve(uneven_problem(.9, .3), field_options());
  const double columns = static_cast<double>(solution.box.columns());
  const double in_cells = std::accumulate(solution.absorbed_power.begin(), solution.absorbed_power.end(), 0.) / columns;
  const auto net_down = [&](std::size_t e) {
    return solution.profile_direct_flux[e] + solution.profile_downwelling_diffuse_flux[e] -
           solution.profile_upwelling_flux[e];
  };
  Worst worst;
  worst.meet(in_cells / sun_cosine, solution.ledger.absorptance);
  worst.meet((net_down(solution.profile_upwelling_flux.size() - 1) - net_down(0)) / sun_cosine,
             solution.ledger.absorptance);
  worst.meet(solution.ledger.residual);
  return worst.value();
}

// The ground reflects its albedo's share of the incident flux: in the field, and below the same medium as one layer.
double ground_reflection() {
  constexpr double albedo = .3;
  const Solution field = solve(uneven_problem(.9, albedo), field_options());
  Problem layer = layer_problem(2, .9, droplets(), sun_cosine);
  layer.surface.albedo = albedo;
  const Solution column = solve(layer, column_options("draft"));
  Worst worst;
  for (const Solution* solution : {&field, &column}) {
    const double down = solution->profile_direct_flux.front() + solution->profile_downwelling_diffuse_flux.front();
    worst.meet(solution->profile_upwelling_flux.front() / (albedo * down), 1);
  }
  return worst.value();
}

// The same column by column, over ground that is dark and bright by turns.
double ground_map() {
  Problem problem = uneven_problem(.9, 0);
  for (std::size_t c = 0; c < problem.grid.box.columns(); ++c)
    problem.surface.albedo_map.push_back(c % 2 == 0 ? .8F : .2F);
  const Solution solution = solve(problem, field_options());
  Worst worst;
  for (std::size_t c = 0; c < problem.surface.albedo_map.size(); ++c) {
    const float down = solution.direct_flux[c] + solution.downwelling_diffuse_flux[c];
    worst.meet(static_cast<double>(solution.upwelling_flux[c] / (problem.surface.albedo_map[c] * down)), 1);
  }
  return worst.value();
}

// No sun, a sky of radiance 1 all over, nothing absorbs: radiance is 1 everywhere, whatever scatters.
Problem furnace(const PhaseFunction& phase, const ExtinctionField& field) {
  Problem problem = field_problem(field, 1, phase, {});
  problem.sun.reset();
  problem.sky_radiance = 1;
  problem.surface.albedo = 1;
  return problem;
}

SolverOptions furnace_options() {
  SolverOptions options = field_options();
  options.tolerance = 1e-5;
  options.radiance_field = true;
  return options;
}

double furnace_radiance() {
  Worst worst;
  // A cloud with holes, and one without.
  for (const auto& field :
       {uneven_field(6, 5, 4, 4), ExtinctionField{4, 4, 4, std::vector<float>(64, 1.5F), {1, 1, 1}}}) {
    const Solution solution = solve(furnace(PhaseFunction::isotropic(), field), furnace_options());
    for (const float radiance : solution.radiance_field->radiance) worst.meet(static_cast<double>(radiance), 1);
  }
  return worst.value();
}

double furnace_flux() {
  Worst worst;
  SolverOptions options = furnace_options();
  options.radiance_field = false;
  const auto meet_profiles = [&worst](const Solution& solution) {
    for (const auto* profile : {&solution.profile_upwelling_flux, &solution.profile_downwelling_diffuse_flux})
      for (const double flux : *profile) worst.meet(flux / pi, 1);
    worst.meet(solution.ledger.reflectance, 1);
  };
  meet_profiles(solve(furnace(droplets(), uneven_field(6, 5, 4, 4)), options));
  Problem column = layer_problem(8, 1, droplets(), 1);
  column.sun.reset();
  column.sky_radiance = 1;
  column.surface.albedo = 1;
  SolverOptions fine = column_options("draft");
  fine.tolerance = 1e-5;
  meet_profiles(solve(column, fine));
  return worst.value();
}

double no_matter() {
  Worst worst;
  for (const bool periodic : {true, false}) {
    Problem problem = field_problem(uneven_field(5, 4, 3, 0), 1, droplets(), sun_at(sun_cosine, 37), periodic);
    problem.surface.albedo = .25;
    const Solution solution = solve(problem, field_options());
    for (const float flux : solution.direct_flux) worst.meet(static_cast<double>(flux) / sun_cosine, 1);
    for (const float flux : solution.downwelling_diffuse_flux) worst.meet(static_cast<double>(flux) / sun_cosine);
    worst.meet(solution.ledger.residual);
    if (!periodic) continue;  // light reflected by the ground leaves through the sides
    for (const float flux : solution.upwelling_flux) worst.meet(static_cast<double>(flux) / sun_cosine, .25);
    worst.meet(solution.ledger.reflectance, .25);
  }
  return worst.value();
}

double linearity() {
  Problem problem = uneven_problem(.9, .3);
  const Solution one = solve(problem, field_options());
  problem.sun->irradiance = 1361;
  const Solution many = solve(problem, field_options());
  Worst worst;
  for (std::size_t n = 0; n < one.upwelling_flux.size(); ++n) {
    worst.meet(static_cast<double>(many.upwelling_flux[n]) / static_cast<double>(one.upwelling_flux[n]) / 1361, 1);
    worst.meet((static_cast<double>(many.direct_flux[n]) / 1361 - static_cast<double>(one.direct_flux[n])) /
               sun_cosine);
  }
  for (std::size_t n = 0; n < one.absorbed_power.size(); ++n)
    worst.meet(static_cast<double>(many.absorbed_power[n]) / 1361 - static_cast<double>(one.absorbed_power[n]));
  return worst.value();
}

}  // namespace

std::vector<PhysicalCheck> energy_checks() {
  // The solver goes on until its ledger closes to 1e-5; the rest is float.
  constexpr double ledger = 1.1e-5;
  return {
      {"no-matter", "sunlight passes through empty air untouched, and the ground sends its share back", "of incident",
       1e-6, no_matter},  // roundings in float
      {"energy-layer", "a layer that absorbs nothing sends all light up or into the ground", "of incident", ledger,
       column_energy},
      {"energy-field", "a field that absorbs nothing sends all light up or into the ground", "of incident", ledger,
       field_energy},
      {"energy-open-sides", "light that enters through the top and the sides is accounted for", "of incident", ledger,
       open_energy},
      // It enters as whole rays, four by four a column of some two that it crosses.
      {"open-sides-beam", "the beam enters through open sides as the sun sees them", "of it", .05, beam_through_sides},
      // Profile and cells take the iteration's last change, below its tolerance of 1e-3, in different ways.
      {"absorbed-power", "cells absorb what fluxes lose", "of incident", 1e-4, absorbed_power},
      {"ground-reflection", "the ground sends up its albedo's share of what comes down", "of the flux", 1e-5,
       ground_reflection},
      // Gathered fluxes are scaled to the means of the iteration, which that of a map need not match.
      {"ground-map", "and does so column by column if albedos differ", "of the flux", .02, ground_map},
      // Isotropic scattering is reciprocal on any points. Slopes of light are found at an estimated error of 1e-2, and
      // leave 9e-5 in uneven clouds.
      {"furnace-radiance", "under a uniform sky, if nothing absorbs, radiance is the sky's everywhere", "of the sky's",
       2e-4, furnace_radiance},
      // The matrices of anisotropic scattering conserve power but are not quite reciprocal: 6e-4 at `draft`.
      {"furnace-flux", "and so are the fluxes, in a cloud that scatters forward", "of the sky's", 1.5e-3, furnace_flux},
      // The same iterations, rounded elsewhere.
      {"linearity", "light is proportional to the sun's irradiance", "of the flux", 5e-6, linearity},
  };
}

}  // namespace cloudbow
