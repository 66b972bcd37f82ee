// Thermal emission. Truth: equilibrium in an enclosure of one temperature, line integrals without scattering, sums of
// problems, the diffusion limit; plane-parallel answers are those of test_columns and of the validation drivers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/grid_map.hpp"
#include "cloudbow/transport/solver.hpp"
#include "emitting_slabs.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

/// Planck radiance bottom + slope z in all matter.
void set_planck(OpticalGrid& grid, double bottom, double slope = 0) {
  grid.planck.assign(grid.active_cells(), 0.F);
  grid.planck_step.assign(grid.active_cells(), 0.F);
  const BoxGrid& box = grid.box;
  for (int k = 0; k < box.nz(); ++k) {
    const double middle = bottom + slope * .5 * (box.z_edge_m[k] + box.z_edge_m[k + 1]);
    const double step = slope * box.thickness_m(k);
    grid.layer_planck.push_back(middle);
    grid.layer_planck_step.push_back(step);
    for (std::size_t c = grid.first_cell(k); c < grid.first_cell(k + 1); ++c) {
      grid.planck[c] = static_cast<float>(middle);
      grid.planck_step[c] = static_cast<float>(step);
    }
  }
}

Problem thermal_problem(OpticalGrid grid, double bottom = 1, double slope = 0) {
  Problem problem;
  problem.grid = std::move(grid);
  set_planck(problem.grid, bottom, slope);
  problem.phase.assign(problem.grid.scattering.size(), PhaseFunction::henyey_greenstein(.85));
  problem.surface.planck = bottom;
  return problem;
}

SolverOptions thermal_options() {
  SolverOptions options = coarse_options();
  options.tolerance = 1e-7;
  options.energy_tolerance = 1e-6;
  options.max_sweeps = 400;
  return options;
}

double largest_departure(const std::vector<float>& field, double from) {
  double worst = 0;
  for (const float value : field) worst = std::max(worst, std::abs(static_cast<double>(value) - from));
  return worst;
}

Surface surface_of(int kind, const BoxGrid& box) {
  Surface surface;
  switch (kind) {
    case 0:
      break;
    case 1:
      surface.albedo = .3;
      break;
    case 2:
      surface.albedo = 1;
      break;
    case 3:
      for (std::size_t c = 0; c < box.columns(); ++c) surface.albedo_map.push_back(static_cast<float>(c % 3) / 2.F);
      break;
    case 4:
      surface.brdf = SurfaceBrdf::cox_munk(7, 1.33);
      break;
    case 5:
      surface.brdf = SurfaceBrdf::rpv(.1, .7, -.1, .1);
      break;
    default:
      surface.brdf = SurfaceBrdf::rpv(.3, .8, .1, .3);
      surface.tilt = {20, 40};
  }
  return surface;
}

// Ground, sky and matter of one temperature: the radiance is B everywhere, and nothing absorbs more than it emits.
// Tolerance: float sums some 100 directions of values with errors of 6e-8.
TEST(Thermal, NothingHappensInAnEnclosureOfOneTemperature) {
  const double planck = 7.3;
  for (const bool periodic : {true, false}) {
    for (const double ssa : {0., .5, 1 - 1e-6, 1 - 1e-9}) {
      for (const double largest : {1e-6, 1., 30., 1e4}) {
        const BoxGrid box = make_box(4, 3, 4, periodic);
        Problem problem = thermal_problem(make_grid(box, random_extinction(box, largest, 5), ssa), planck);
        const int kind = static_cast<int>(largest > 1) + 2 * static_cast<int>(ssa > .6);
        problem.surface = surface_of(kind, box);
        problem.surface.planck = planck;
        problem.sky_radiance = planck;
        SolverOptions options = thermal_options();
        options.views.push_back({"nadir", {0, 0, 1}});
        options.views.push_back({"slant", travel_along(.4, 30)});
        const Solution solution = solve(problem, options);
        const auto where = [&] {
          return testing::Message() << "periodic " << periodic << " ssa " << ssa << " depth " << largest;
        };
        EXPECT_LT(largest_departure(solution.upwelling_flux, pi * planck), 2e-6 * pi * planck) << where();
        EXPECT_LT(largest_departure(solution.downwelling_diffuse_flux, pi * planck), 2e-6 * pi * planck) << where();
        for (const RadianceImage& image : solution.images)
          EXPECT_LT(largest_departure(image.radiance, planck), 2e-6 * planck) << where();
        double most = 0;
        for (std::size_t c = 0; c < problem.grid.active_cells(); ++c)
          most = std::max(most, static_cast<double>(problem.grid.absorption[c]));
        EXPECT_LT(largest_departure(solution.absorbed_power, 0), 1e-6 * planck * std::max(1., 4 * pi * most))
            << where();
        EXPECT_TRUE(solution.report.converged) << where();
        EXPECT_NEAR(solution.ledger.residual, 0, 1e-6) << where();
      }
    }
  }
}

// Emissivity is one less the reflection that the solve uses, whatever the surface.
TEST(Thermal, EverySurfaceIsInEquilibrium) {
  for (int kind = 0; kind < 7; ++kind) {
    const BoxGrid box = make_box(3, 4, 3);
    Problem problem = thermal_problem(make_grid(box, random_extinction(box, 2, 7), .6), 1);
    problem.surface = surface_of(kind, box);
    problem.surface.planck_map.assign(box.columns(), 1.F);
    problem.sky_radiance = 1;
    SolverOptions options = thermal_options();
    options.views.push_back({"slant", travel_along(.5, 100)});
    const Solution solution = solve(problem, options);
    EXPECT_LT(largest_departure(solution.upwelling_flux, pi), 2e-6 * pi) << kind;
    EXPECT_LT(largest_departure(solution.images[0].radiance, 1), 2e-6) << kind;
    EXPECT_NEAR(solution.ledger.residual, 0, 1e-6) << kind;
    EXPECT_NEAR(solution.ledger.surface_absorptance, solution.ledger.surface_emission, 2e-6) << kind;
  }
}

double rms_difference(const std::vector<float>& a, const std::vector<double>& b, std::size_t first = 0) {
  double sum = 0;
  for (std::size_t c = first; c < a.size(); ++c) sum += std::pow(static_cast<double>(a[c]) - b[c], 2);
  return std::sqrt(sum / static_cast<double>(a.size() - first));
}

// A cloud over a white ground emits as much as it would absorb of a sky of its temperature. With
// constant sources the tolerance is that of the two iterations. Limits of slopes differ between the two sources: .3 %
// of pi B in this ragged cloud.
TEST(Thermal, AnIsothermalCloudEmitsWhatItWouldAbsorb) {
  const BoxGrid box = make_box(6, 5, 6);
  Problem emitting = thermal_problem(make_grid(box, random_extinction(box, 3, 11), .7), 1);
  emitting.surface.albedo = 1;
  Problem lit = emitting;
  lit.grid.planck.clear();
  lit.grid.planck_step.clear();
  lit.surface.planck = 0;
  lit.sky_radiance = 1;
  for (const bool linear : {false, true}) {
    SolverOptions options = thermal_options();
    options.linear_source = linear;
    const Solution emitted = solve(emitting, options);
    const Solution reflected = solve(lit, options);
    std::vector<double> lacking;
    for (const float up : reflected.upwelling_flux) lacking.push_back(pi - static_cast<double>(up));
    const std::size_t top = emitted.upwelling_flux.size() - box.columns();
    EXPECT_LT(rms_difference(emitted.upwelling_flux, lacking, top), (linear ? 3e-3 : 1e-5) * pi);
  }
}

// Without scattering a radiance is an integral along a line; B is linear in height.
TEST(Thermal, NadirRadianceWithoutScatteringIsALineIntegral) {
  const BoxGrid box = make_box(4, 4, 3);
  for (const double depth : {.1, 1., 10.}) {
    std::vector<float> extinction(cells_of(box), 0.F);
    for (std::size_t c = 0; c < extinction.size(); ++c) {
      const std::size_t i = c % 4, j = c / 4 % 4, k = c / 16;
      if ((i + j + k) % 2 == 0) extinction[c] = static_cast<float>(depth);
    }
    const double bottom = 2, slope = -.5;
    Problem problem = thermal_problem(make_grid(box, extinction, 0.), bottom, slope);
    problem.surface.planck = 3;
    SolverOptions options = thermal_options();
    options.views.push_back({"nadir", {0, 0, 1}});
    const Solution solution = solve(problem, options);
    for (std::size_t column = 0; column < box.columns(); ++column) {
      double radiance = 3;
      for (int k = 0; k < 3; ++k) {
        const double t = extinction[static_cast<std::size_t>(k) * 16 + column];
        if (t == 0) continue;
        const double below = bottom + slope * k, above = below + slope;
        // Integral of B e^-(t - s) ds with B linear in s.
        radiance = radiance * std::exp(-t) + above - below * std::exp(-t) + (below - above) / t * -std::expm1(-t);
      }
      EXPECT_NEAR(solution.images[0].radiance[column], radiance, 1e-5 * radiance) << depth;
    }
  }
}

// Net power is the divergence of the flux. Tolerance: that of the ledger.
TEST(Thermal, NetAbsorbedPowerIsWhatFluxesLeaveBehind) {
  for (const bool lambertian : {true, false}) {
    const BoxGrid box = make_box(5, 4, 6);
    Problem problem = thermal_problem(make_grid(box, random_extinction(box, 4, 3), .5), 2, -.2);
    problem.sky_radiance = .1;
    if (!lambertian) problem.surface.brdf = SurfaceBrdf::rpv(.1, .7, -.1, .1);
    const Solution solution = solve(problem, thermal_options());
    for (int k = 0; k < box.nz(); ++k) {
      double absorbed = 0;
      for (std::size_t c = 0; c < box.columns(); ++c)
        absorbed += solution.absorbed_power[static_cast<std::size_t>(k) * box.columns() + c];
      absorbed /= static_cast<double>(box.columns());
      const auto net_down = [&](int edge) {
        return solution.profile_downwelling_diffuse_flux[edge] - solution.profile_upwelling_flux[edge];
      };
      EXPECT_NEAR(absorbed, net_down(k + 1) - net_down(k), 1e-5 * pi) << k;
    }
    EXPECT_NEAR(solution.ledger.residual, 0, 1e-6);
  }
}

// Deep inside an opaque medium with B linear in height the net flux is that of diffusion.
TEST(Thermal, OpaqueMatterConductsByDiffusion) {
  const BoxGrid box = make_box(2, 2, 9);
  for (const double depth : {10., 100.}) {
    const double slope = .1;
    Problem problem =
        thermal_problem(make_grid(box, std::vector<float>(cells_of(box), static_cast<float>(depth)), 0.), 1, slope);
    problem.sky_radiance = 1 + slope * 9;
    SolverOptions options = thermal_options();
    options.directions = "double-gauss-8x16";
    const Solution solution = solve(problem, options);
    const double wanted = -4 * pi / 3 * slope / depth;
    for (const int edge : {4, 5}) {
      const double net = solution.profile_upwelling_flux[edge] - solution.profile_downwelling_diffuse_flux[edge];
      EXPECT_NEAR(net / wanted, 1, 1e-3) << depth;
    }
  }
}

// Light of sun and matter adds. With constant sources the tolerance is that of the iterations; for fluxes .1 % of pi B,
// because each gathered field is scaled to its own mean. Limits of slopes are not linear: .3 % in this ragged cloud.
TEST(Thermal, SunAndEmissionAdd) {
  const BoxGrid box = make_box(4, 4, 5);
  const Problem emission = thermal_problem(make_grid(box, random_extinction(box, 2, 13), .6), 1, -.05);
  Problem both = emission;
  both.sun = Sun{travel_along(-.6, 20), 3};
  Problem sun = both;
  sun.grid.planck.clear();
  sun.grid.planck_step.clear();
  sun.surface.planck = 0;
  for (const bool linear : {false, true}) {
    SolverOptions options = thermal_options();
    options.linear_source = linear;
    const Solution a = solve(emission, options);
    const Solution b = solve(sun, options);
    const Solution sum = solve(both, options);
    const double tolerance = linear ? 3e-3 : 5e-6;
    std::vector<double> flux, power;
    for (std::size_t c = 0; c < a.upwelling_flux.size(); ++c)
      flux.push_back(static_cast<double>(a.upwelling_flux[c]) + static_cast<double>(b.upwelling_flux[c]));
    for (std::size_t c = 0; c < a.absorbed_power.size(); ++c)
      power.push_back(static_cast<double>(a.absorbed_power[c]) + static_cast<double>(b.absorbed_power[c]));
    EXPECT_LT(rms_difference(sum.upwelling_flux, flux), std::max(tolerance, 1e-3) * pi);
    EXPECT_LT(rms_difference(sum.absorbed_power, power), tolerance * pi);
  }
}

// The slab as 4 x 4 columns of cells of at most this depth.
Problem voxels_of(const SlabCase& slab, double largest) {
  Problem problem;
  BoxGrid box = make_box(4, 4, 0);
  std::vector<double> planck, step;
  std::vector<const SlabLayer*> layer;
  for (std::size_t l = slab.layers.size(); l-- > 0;) {
    const SlabLayer& of = slab.layers[l];
    problem.phase.push_back(of.g < 0   ? PhaseFunction::rayleigh()
                            : of.g > 0 ? PhaseFunction::henyey_greenstein(of.g)
                                       : PhaseFunction::isotropic());
    const int parts = static_cast<int>(std::ceil(of.depth / largest - 1e-9));
    for (int n = 0; n < parts; ++n) {
      box.z_edge_m.push_back(box.z_edge_m.back() + of.depth / parts);
      const double above = slab.planck[l] - slab.planck[l + 1];
      planck.push_back(slab.planck[l + 1] + above * (n + .5) / parts);
      step.push_back(above / parts);
      layer.push_back(&of);
    }
  }
  std::vector<float> absorption;
  std::vector<std::vector<float>> scattering(slab.layers.size());
  for (const SlabLayer* of : layer) {
    for (std::size_t c = 0; c < box.columns(); ++c) {
      absorption.push_back(static_cast<float>(1 - of->single_scattering_albedo));
      for (std::size_t p = 0; p < scattering.size(); ++p) {
        const bool own = &slab.layers[scattering.size() - 1 - p] == of;
        scattering[p].push_back(own ? static_cast<float>(of->single_scattering_albedo) : 0.F);
      }
    }
  }
  problem.grid = make_grid(box, absorption, scattering);
  problem.grid.layer_planck = planck;
  problem.grid.layer_planck_step = step;
  for (int k = 0; k < box.nz(); ++k) {
    for (std::size_t c = problem.grid.first_cell(k); c < problem.grid.first_cell(k + 1); ++c) {
      problem.grid.planck.push_back(static_cast<float>(planck[k]));
      problem.grid.planck_step.push_back(static_cast<float>(step[k]));
    }
  }
  problem.surface.albedo = slab.albedo;
  problem.surface.planck = slab.ground;
  problem.sky_radiance = slab.sky;
  if (slab.mu0 > 0) problem.sun = Sun{travel_along(-slab.mu0, 20), 1.};
  return problem;
}

// Fluxes and radiances of slabs in three dimensions, at the levels `balanced` and `fine`, against discrete ordinates.
TEST(Thermal, SlabsOfVoxelsAreThoseOfDiscreteOrdinates) {
  struct Level {
    const char* name;
    SolverOptions options;
    double cell, flux, radiance;  // depth of a cell, per largest pi B, per largest radiance
  };
  SolverOptions balanced;
  SolverOptions fine;
  fine.directions = "double-gauss-12x24";
  fine.fit.delta_m_order = 10;
  fine.fit.beam_delta_m_order = 14;
  fine.gather_directions = 2048;
  fine.tolerance = 1e-5;
  for (Level& level : std::vector<Level>{{"balanced", balanced, .5, 5e-3, .04}, {"fine", fine, .1, 1e-3, .01}}) {
    for (const SlabCase& slab : discrete_ordinates()) {
      SolverOptions options = level.options;
      options.flux_levels = FluxLevels::boundaries;
      for (const double mu : slab_cosines) {
        for (std::size_t a = 0; a < slab.up.size(); ++a) {
          const double azimuth = 20 + 90 * static_cast<double>(a);
          options.views.push_back({"up", travel_along(mu, azimuth)});
          options.views.push_back({"down", travel_along(-mu, azimuth)});
        }
      }
      const Problem problem = voxels_of(slab, slab.layers[0].single_scattering_albedo > 0 ? level.cell : 10);
      const Solution solution = solve(problem, options);
      const double planck =
          std::max({slab.ground, slab.sky, *std::max_element(slab.planck.begin(), slab.planck.end())});
      const double up = solution.profile_upwelling_flux.back();
      const double down = solution.profile_downwelling_diffuse_flux.front() + solution.profile_direct_flux.front();
      EXPECT_NEAR(up, slab.levels.front().up, level.flux * pi * planck) << level.name << ' ' << slab.name;
      EXPECT_NEAR(down, slab.levels.back().down, level.flux * pi * planck) << level.name << ' ' << slab.name;
      double worst = 0, largest = 0;
      std::size_t image = 0;
      for (std::size_t m = 0; m < slab_cosines.size(); ++m) {
        for (std::size_t a = 0; a < slab.up.size(); ++a) {
          for (const auto* wanted : {&slab.up, &slab.down}) {
            const double found = solution.images[image++].radiance[0];
            worst = std::max(worst, std::abs(found - (*wanted)[a][m]));
            largest = std::max(largest, (*wanted)[a][m]);
          }
        }
      }
      // Near the sun's direction light of its forward peak is the larger error.
      EXPECT_LT(worst / largest, slab.mu0 > 0 ? .1 : level.radiance) << level.name << ' ' << slab.name;
    }
  }
}

// A problem without emission has the ledger of one.
TEST(Thermal, LedgerWithoutEmissionHasIncidentLightAlone) {
  const BoxGrid box = make_box(4, 4, 5);
  Problem problem = thermal_problem(make_grid(box, random_extinction(box, 2, 17), .9), 1);
  problem.grid.planck.clear();
  problem.grid.planck_step.clear();
  problem.surface.planck = 0;
  problem.sun = Sun{travel_along(-.6, 20), 3};
  const Solution solution = solve(problem, thermal_options());
  EXPECT_FALSE(solution.emits);
  EXPECT_EQ(solution.ledger.incident, 1);
  EXPECT_EQ(solution.ledger.surface_emission, 0);
}

TEST(Thermal, SameBitsForAnyNumberOfThreads) {
  const BoxGrid box = make_box(20, 20, 16);
  const Problem problem = thermal_problem(make_grid(box, random_extinction(box, 2, 19), .6), 1, -.02);
  SolverOptions options = thermal_options();
  options.tolerance = 1e-4;
  options.threads = 1;
  const Solution one = solve(problem, options);
  for (const int threads : {2, 3}) {
    options.threads = threads;
    const Solution many = solve(problem, options);
    EXPECT_EQ(many.upwelling_flux, one.upwelling_flux);
    EXPECT_EQ(many.absorbed_power, one.absorbed_power);
  }
}

TEST(Thermal, PlanckRadiancesOutOfRangeAreRefused) {
  const BoxGrid box = make_box(2, 2, 2);
  Problem problem = thermal_problem(make_grid(box, random_extinction(box, 2, 19), .6), 1);
  problem.grid.planck_step[0] = 3;
  EXPECT_THROW(solve(problem, thermal_options()), InputError);
  problem.grid.planck_step[0] = 0;
  problem.grid.planck[0] = 1e-30F;
  EXPECT_THROW(solve(problem, thermal_options()), InputError);
}

}  // namespace
}  // namespace cloudbow
