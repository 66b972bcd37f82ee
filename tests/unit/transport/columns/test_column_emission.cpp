// Thermal emission in columns solved without iteration. Truth: furnaces, the emissivity of an isothermal absorber, the
// diffusion limit, discrete ordinates (cdisort), superposition, and energy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "emitting_slabs.hpp"
#include "transport/columns/columns.hpp"
#include "transport/columns/distinct_columns.hpp"
#include "transport/problem/power.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

SolverOptions by_columns(int streams = 8) {
  SolverOptions options;
  options.independent_columns = true;
  options.column_streams = streams;
  options.actinic = true;
  return options;
}

Solution solve_in(bool in_double, const Problem& problem, const SolverOptions& options) {
  return in_double ? solve_columns<double>(problem, options, {}) : solve_columns<float>(problem, options, {});
}

// A cell of a column: optical depth, and Planck radiance at its two faces.
struct Cell {
  double depth, single_scattering_albedo;
  PhaseFunction phase;
  double planck_top, planck_bottom;
};

// One column of the cells, from the top down. Extinction is 1/m.
Problem column_of(const std::vector<Cell>& cells) {
  const int nz = static_cast<int>(cells.size());
  BoxGrid box = make_box(1, 1, nz);
  std::vector<float> absorption, planck, step;
  std::vector<std::vector<float>> scattering(cells.size(), std::vector<float>(cells.size(), 0.F));
  Problem problem;
  for (int k = 0; k < nz; ++k) {
    const Cell& cell = cells[nz - 1 - k];
    box.z_edge_m[k + 1] = box.z_edge_m[k] + cell.depth;
    absorption.push_back(static_cast<float>(1 - cell.single_scattering_albedo));
    scattering[k][k] = static_cast<float>(cell.single_scattering_albedo);
    planck.push_back(static_cast<float>((cell.planck_top + cell.planck_bottom) / 2));
    step.push_back(static_cast<float>(cell.planck_top - cell.planck_bottom));
    problem.phase.push_back(cell.phase);
  }
  problem.grid = make_grid(box, absorption, scattering);
  problem.grid.planck = planck;
  problem.grid.planck_step = step;
  return problem;
}

PhaseFunction phase_of(double g) { return g > 0 ? PhaseFunction::henyey_greenstein(g) : PhaseFunction::isotropic(); }

// Cells of random extinction, a third of them empty, and of random Planck radiance between 1 and 2 at their faces.
Problem random_columns(double largest, double single_scattering_albedo) {
  const BoxGrid box = make_box(6, 5, 7);
  Problem problem;
  problem.grid = make_grid(box, random_extinction(box, largest, 3), single_scattering_albedo);
  problem.phase = {PhaseFunction::henyey_greenstein(.85)};
  Random random(11);
  for (std::size_t c = 0; c < problem.grid.active_cells(); ++c) {
    problem.grid.planck.push_back(static_cast<float>(1.25 + .5 * random()));
    problem.grid.planck_step.push_back(static_cast<float>(.5 * (random() - .5)));
  }
  for (std::size_t c = 0; c < box.columns(); ++c) {
    problem.surface.planck_map.push_back(static_cast<float>(1 + random()));
    problem.surface.albedo_map.push_back(static_cast<float>(random()));
  }
  return problem;
}

// Cells end at interfaces, and at the levels if `cut`.
Problem problem_of(const SlabCase& c, bool cut) {
  std::vector<Cell> cells;
  double top = 0;
  for (std::size_t l = 0; l < c.layers.size(); ++l) {
    const SlabLayer& layer = c.layers[l];
    std::vector<double> edge = {top};
    for (const SlabLevel& level : c.levels) {
      if (cut && level.depth > top && level.depth < top + layer.depth) edge.push_back(level.depth);
    }
    edge.push_back(top + layer.depth);
    const auto planck = [&](double depth) {
      return c.planck[l] + (c.planck[l + 1] - c.planck[l]) * (depth - top) / layer.depth;
    };
    for (std::size_t e = 0; e + 1 < edge.size(); ++e) {
      cells.push_back({edge[e + 1] - edge[e], layer.single_scattering_albedo,
                       layer.g < 0 ? PhaseFunction::rayleigh() : phase_of(layer.g), planck(edge[e]),
                       planck(edge[e + 1])});
    }
    top += layer.depth;
  }
  Problem problem = column_of(cells);
  problem.surface.albedo = c.albedo;
  problem.surface.planck = c.ground;
  problem.sky_radiance = c.sky;
  if (c.mu0 > 0) problem.sun = Sun{travel_along(-c.mu0, 20), 1.};
  return problem;
}

TEST(ColumnEmission, SlabsHaveTheFluxesOfDiscreteOrdinates) {
  struct Accuracy {
    int streams;
    bool in_double;
    double ends, levels;  // per largest Planck radiance
  };
  // At the ends the streams err by 7e-6 and 1e-7. Float adds 2e-6. The weights of Gauss's rule miss 2 E3(.1) by 6e-5
  // with 8 streams, and by 6e-7 with 16. This is the error of levels so close to a cold end.
  for (const Accuracy& a :
       {Accuracy{8, true, 1e-5, 2.2e-4}, {8, false, 1e-5, 2.2e-4}, {16, true, 1e-6, 2.2e-6}, {16, false, 4e-6, 5e-6}}) {
    for (const SlabCase& c : discrete_ordinates()) {
      const double planck = std::max(c.ground, *std::max_element(c.planck.begin(), c.planck.end()));
      const Solution whole = solve_in(a.in_double, problem_of(c, false), by_columns(a.streams));
      EXPECT_NEAR(whole.upwelling_flux.back(), c.levels.front().up, a.ends * planck) << c.name << " " << a.streams;
      EXPECT_NEAR(whole.downwelling_diffuse_flux[0] + whole.direct_flux[0], c.levels.back().down, a.ends * planck)
          << c.name << " " << a.streams;
      const Solution cut = solve_in(a.in_double, problem_of(c, true), by_columns(a.streams));
      ASSERT_EQ(cut.upwelling_flux.size(), c.levels.size());
      for (std::size_t e = 0; e < c.levels.size(); ++e) {
        const SlabLevel& level = c.levels[c.levels.size() - 1 - e];
        EXPECT_NEAR(cut.upwelling_flux[e], level.up, a.levels * planck) << c.name << " " << level.depth;
        EXPECT_NEAR(cut.downwelling_diffuse_flux[e] + cut.direct_flux[e], level.down, a.levels * planck)
            << c.name << " " << level.depth;
      }
      EXPECT_LT(std::abs(cut.ledger.residual), a.in_double ? 1e-13 : 2e-6) << c.name;
    }
  }
}

// Planck radiance in a band of wavenumbers [1/cm], by Simpson's rule.
double planck_in_band(double temperature_k, double from, double to) {
  constexpr double h = 6.62607015e-34, c = 2.99792458e8, k = 1.380649e-23;
  if (temperature_k <= 0) return 0;
  // Beyond 60 kT nothing is left.
  const double end = std::min(to, 60 * k * temperature_k / (h * c) / 100);
  const auto at = [&](double per_cm) {
    const double per_m = 100 * per_cm;
    return per_m > 0 ? 100 * 2 * h * c * c * std::pow(per_m, 3) / std::expm1(h * c * per_m / (k * temperature_k)) : 0;
  };
  constexpr int steps = 4000;
  double sum = at(from) + at(end);
  for (int i = 1; i < steps; ++i) sum += (i % 2 == 1 ? 4 : 2) * at(from + (end - from) * i / steps);
  return sum * (end - from) / steps / 3;
}

TEST(ColumnEmission, BandsHaveTheFluxesOfDisort) {
  // DISORT 4.0.99, test problems 7a and 7c, as stored in github.com/LDEO-CREW/Pythonic-DISORT (MIT), commit 04f1e567.
  Problem problem = column_of({{1, .1, phase_of(.05), planck_in_band(200, 300, 800), planck_in_band(300, 300, 800)}});
  Solution solution = solve_in(true, problem, by_columns(16));
  // Printed to seven digits; constants of physics differ in the sixth.
  EXPECT_NEAR(solution.upwelling_flux[1] / 86.2935715, 1, 1e-5);
  EXPECT_NEAR(solution.downwelling_diffuse_flux[0] / 121.203537, 1, 1e-5);

  const auto planck = [](double temperature_k) { return planck_in_band(temperature_k, 0, 80000); };
  problem = column_of({{1, .5, phase_of(.8), planck(300), planck(200)}});
  problem.sun = Sun{travel_along(-.5, 0), 200};
  problem.sky_radiance = planck(100) + 100;
  problem.surface.planck = planck(320);
  solution = solve_in(true, problem, by_columns(16));
  // 12 streams without a correction for the beam's peak.
  EXPECT_NEAR(solution.upwelling_flux[1] / 429.571716, 1, 1e-3);
  EXPECT_NEAR(solution.upwelling_flux[0] / 594.576172, 1, 1e-3);
  EXPECT_NEAR(solution.downwelling_diffuse_flux[1] / 319.830, 1, 1e-3);
  EXPECT_NEAR(solution.downwelling_diffuse_flux[0] / 301.333710, 1, 1e-3);
  EXPECT_NEAR(solution.direct_flux[0] / 13.5335283, 1, 1e-5);
}

TEST(ColumnEmission, FurnacesStayAtTheirRadiance) {
  for (const bool in_double : {true, false}) {
    double flux = 0, power = 0;
    for (const double single_scattering_albedo : {0., .5, .99, 1 - 1e-6, 1 - 1e-9}) {
      for (const double depth : {1e-6, 1e-3, .1, 1., 10., 1e3, 1e5}) {
        for (const double albedo : {0., .3, 1.}) {
          const Cell cell{depth, single_scattering_albedo, phase_of(.85), .7, .7};
          Problem problem = column_of({cell, cell});
          const double planck = static_cast<double>(problem.grid.planck[0]);
          problem.surface.planck = problem.sky_radiance = planck;
          problem.surface.albedo = albedo;
          const Solution s = solve_in(in_double, problem, by_columns());
          for (int e = 0; e <= 2; ++e) {
            flux = std::max({flux, std::abs(s.profile_upwelling_flux[e] / (pi * planck) - 1),
                             std::abs(s.profile_downwelling_diffuse_flux[e] / (pi * planck) - 1)});
          }
          for (const float net : s.absorbed_power)
            power = std::max(power, std::abs(static_cast<double>(net)) * depth / planck);
        }
      }
    }
    // Of B, and per cell for the power.
    EXPECT_LT(flux, in_double ? 1e-12 : 1e-6);
    EXPECT_LT(power, in_double ? 1e-12 : 1e-6);
  }
}

TEST(ColumnEmission, AnIsothermalAbsorberHasTheEmissivityOfTheThirdExponentialIntegral) {
  for (const double depth : {1e-6, 1e-4, .2, .3, 1., 3., 30., 1e4}) {
    const double e1 = -std::expint(-depth);
    const double emissivity = -std::expm1(-depth) + depth * std::exp(-depth) - depth * depth * e1;  // 1 - 2 E3
    // The weights of Gauss's rule with 16 streams miss it by this at small depths.
    const double quadrature = depth < .001 ? 2e-4 : 5e-6;
    for (const int cells : {1, 7}) {
      const Problem problem = column_of(std::vector<Cell>(cells, {depth / cells, 0, PhaseFunction::isotropic(), 2, 2}));
      const Solution s = solve_in(true, problem, by_columns(16));
      EXPECT_NEAR(s.upwelling_flux[cells] / (2 * pi * emissivity), 1, quadrature) << depth;
      EXPECT_NEAR(s.downwelling_diffuse_flux[0] / (2 * pi * emissivity), 1, quadrature) << depth;
      const Solution in_float = solve_in(false, problem, by_columns(16));
      // Thin matter keeps its digits in float, though it emits 1e-6 of B.
      EXPECT_NEAR(in_float.upwelling_flux[cells] / s.upwelling_flux[cells], 1, 2e-6) << depth;
      EXPECT_NEAR(in_float.downwelling_diffuse_flux[0] / s.downwelling_diffuse_flux[0], 1, 2e-6) << depth;
    }
  }
}

TEST(ColumnEmission, OpaqueLinearPlanckRadianceHasTheNetFluxOfDiffusion) {
  for (const bool in_double : {true, false}) {
    for (const double single_scattering_albedo : {0., .5}) {
      std::vector<Cell> cells;
      for (int k = 0; k < 8; ++k)
        cells.push_back({100, single_scattering_albedo, PhaseFunction::isotropic(), 1 + .3 * k, 1.3 + .3 * k});
      const Solution s = solve_in(in_double, column_of(cells), by_columns());
      for (int e = 1; e <= 7; ++e) {
        const double net = s.profile_upwelling_flux[e] - s.profile_downwelling_diffuse_flux[e];
        // Exact, so far from both ends. Float has 1e-7 of B, and the net flux is 4e-3 of B.
        EXPECT_NEAR(net / (4 * pi / 3 * .3 / 100), 1, 1e-3);
        // Float has the cells' Planck radiance with 1e-7, and cells are 100 m high.
        if (e < 7) {
          EXPECT_NEAR(s.absorbed_power[e], 0, 2e-8);
        }
      }
    }
  }
}

TEST(ColumnEmission, CuttingACellChangesNothing) {
  for (const double depth : {1e-3, .2, .3, 4., 100.}) {
    for (const double single_scattering_albedo : {0., .97}) {
      const auto cut_into = [&](int parts) {
        std::vector<Cell> cells;
        for (int k = 0; k < parts; ++k) {
          cells.push_back(
              {depth / parts, single_scattering_albedo, phase_of(.85), 1 + 2. * k / parts, 1 + 2. * (k + 1) / parts});
        }
        return solve_in(true, column_of(cells), by_columns());
      };
      const Solution whole = cut_into(1), cut = cut_into(7);
      // Each cell is exact but for its thinnest part.
      EXPECT_NEAR(whole.upwelling_flux[1] / cut.upwelling_flux[7], 1, 3e-6) << depth;
      EXPECT_NEAR(whole.downwelling_diffuse_flux[0] / cut.downwelling_diffuse_flux[0], 1, 3e-6) << depth;
      const double power = std::accumulate(cut.absorbed_power.begin(), cut.absorbed_power.end(), 0.) / 7;
      EXPECT_NEAR(whole.absorbed_power[0] / power, 1, 3e-6) << depth;
    }
  }
}

TEST(ColumnEmission, IsothermalMatterGlowsAsMuchAsItKeepsOfTheSkysLight) {
  Problem glow = random_columns(4, .8);
  std::fill(glow.grid.planck.begin(), glow.grid.planck.end(), 1.5F);
  std::fill(glow.grid.planck_step.begin(), glow.grid.planck_step.end(), 0.F);
  glow.surface.planck_map.clear();
  glow.surface.planck = 1.5;
  Problem lit = glow;
  lit.grid.planck.clear();
  lit.grid.planck_step.clear();
  lit.surface.planck = 0;
  lit.sky_radiance = 1.5;
  const Solution one = solve_in(true, glow, by_columns());
  const Solution two = solve_in(true, lit, by_columns());
  for (std::size_t c = 0; c < one.upwelling_flux.size(); ++c) {
    // Fields are float.
    EXPECT_NEAR(one.upwelling_flux[c] + two.upwelling_flux[c], 1.5 * pi, 2e-6);
    EXPECT_NEAR(one.downwelling_diffuse_flux[c] + two.downwelling_diffuse_flux[c], 1.5 * pi, 2e-6);
  }
  for (std::size_t c = 0; c < one.actinic_flux.size(); ++c) {
    EXPECT_NEAR(one.actinic_flux[c] + two.actinic_flux[c], 1.5 * 4 * pi, 4e-6);
    EXPECT_NEAR(one.absorbed_power[c] + two.absorbed_power[c], 0, 2e-6);
  }
}

TEST(ColumnEmission, NetAbsorbedPowerIsTheDifferenceOfNetFluxes) {
  double power_error = 0, residual = 0, estimate = 0;
  for (const double depth : {1e-4, .1, 1., 3., 1000.}) {
    for (const double single_scattering_albedo : {0., .5, .999}) {
      for (const bool sun : {false, true}) {
        Problem problem = random_columns(depth, single_scattering_albedo);
        if (sun) problem.sun = Sun{travel_along(-.4, 30), 5};
        problem.sky_radiance = .3;
        const Solution s = solve_in(false, problem, by_columns());
        const EnergyLedger& ledger = s.ledger;
        const std::size_t columns = problem.grid.box.columns();
        const auto net = [&](std::size_t at) {
          return static_cast<double>(s.downwelling_diffuse_flux[at]) + static_cast<double>(s.direct_flux[at]) -
                 static_cast<double>(s.upwelling_flux[at]);
        };
        for (std::size_t c = 0; c < cells_of(problem.grid.box); ++c) {  // of 1 m
          const double error = static_cast<double>(s.absorbed_power[c]) - (net(c + columns) - net(c));
          power_error = std::max(power_error, std::abs(error) / ledger.power);
        }
        residual = std::max(residual, std::abs(ledger.residual));
        estimate = std::max(estimate, s.report.estimated_error);
        EXPECT_TRUE(s.report.converged);
        EXPECT_DOUBLE_EQ(ledger.power, incident_power(problem) + ground_emission(problem) + matter_emission(problem));
        EXPECT_DOUBLE_EQ(ledger.incident, incident_power(problem) / ledger.power);
        EXPECT_DOUBLE_EQ(ledger.surface_emission, ground_emission(problem) / ledger.power);
      }
    }
  }
  // Float: fluxes of 1e-7, up to a hundred doublings and cells.
  EXPECT_LT(power_error, 1e-5);
  EXPECT_LT(residual, 1e-6);
  EXPECT_LT(estimate, 1e-5);
}

TEST(ColumnEmission, NetAbsorbedPowerIsActinicFluxLessEmission) {
  const Problem problem = random_columns(2, .6);
  const Solution s = solve_in(false, problem, by_columns());
  problem.grid.for_each_place([&](int k, std::size_t column, std::size_t cell) {
    const std::size_t voxel = k * problem.grid.box.columns() + column;
    const double emitted = 4 * pi * static_cast<double>(problem.grid.planck[cell]);
    EXPECT_NEAR(s.absorbed_power[voxel], problem.grid.absorption[cell] * (s.actinic_flux[voxel] - emitted), 1e-5);
  });
}

// The largest deviation of `sum` from the sum of the others in any field.
double deviation_from_sum(const Solution& sum, const Solution& one, const Solution& two) {
  double worst = 0;
  for (const auto field : {&Solution::upwelling_flux, &Solution::downwelling_diffuse_flux, &Solution::absorbed_power,
                           &Solution::actinic_flux}) {
    for (std::size_t c = 0; c < (sum.*field).size(); ++c) {
      const double parts = static_cast<double>((one.*field)[c]) + static_cast<double>((two.*field)[c]);
      worst = std::max(worst, std::abs(static_cast<double>((sum.*field)[c]) - parts));
    }
  }
  return worst;
}

TEST(ColumnEmission, SunAndEmissionAddUp) {
  for (const double largest : {.5, 20.}) {
    Problem both = random_columns(largest, .7);
    both.sun = Sun{travel_along(-.4, 30), 3};
    both.sky_radiance = .2;
    Problem emission = both, light = both;
    emission.sun.reset();
    emission.sky_radiance = 0;
    light.grid.planck.clear();
    light.grid.planck_step.clear();
    light.surface.planck_map.clear();
    EXPECT_TRUE(emission.emits());
    EXPECT_FALSE(light.emits());
    for (const bool in_double : {true, false}) {
      for (const bool slanted : {true, false}) {
        SolverOptions options = by_columns();
        options.beam_crosses_columns = slanted;
        const Solution sum = solve_in(in_double, both, options);
        const Solution one = solve_in(in_double, emission, options);
        const Solution two = solve_in(in_double, light, options);
        EXPECT_TRUE(sum.emits && one.emits && !two.emits);
        EXPECT_EQ(two.ledger.incident, 1);
        EXPECT_EQ(two.ledger.surface_emission, 0);
        EXPECT_DOUBLE_EQ(two.ledger.power, incident_power(light));
        // Fields are float, in either case.
        EXPECT_LT(deviation_from_sum(sum, one, two), 1e-6 * sum.ledger.power) << slanted << in_double;
      }
    }
  }
}

TEST(ColumnEmission, GroundGlowsThroughEmptyColumns) {
  Problem problem;
  problem.grid = make_grid(make_box(2, 1, 3), std::vector<float>(6, 0.F), .5);
  problem.phase = {PhaseFunction::isotropic()};
  problem.surface.planck_map = {2, 3};
  problem.surface.albedo = .999;
  const Solution s = solve_in(false, problem, by_columns());
  for (int e = 0; e <= 3; ++e) {
    EXPECT_NEAR(s.upwelling_flux[2 * e] / (.001 * 2 * pi), 1, 1e-6);
    EXPECT_NEAR(s.upwelling_flux[2 * e + 1] / (.001 * 3 * pi), 1, 1e-6);
    EXPECT_NEAR(s.downwelling_diffuse_flux[2 * e], 0, 1e-9);
  }
  EXPECT_NEAR(s.actinic_flux[1] / (2 * .001 * 3 * pi), 1, 1e-6);
  EXPECT_NEAR(s.ledger.reflectance, 1, 1e-6);
  EXPECT_NEAR(s.ledger.surface_emission, 1, 1e-12);
}

TEST(ColumnEmission, TemperatureAloneTellsColumnsApart) {
  const BoxGrid box = make_box(4, 1, 2);
  Problem problem;
  problem.grid = make_grid(box, std::vector<float>(8, 1.F), .5);
  problem.phase = {PhaseFunction::isotropic()};
  const auto kinds = [&] { return distinct_columns(problem, column_cells(problem.grid), std::nullopt).first.size(); };
  problem.grid.planck.assign(8, 1.F);
  problem.grid.planck_step.assign(8, .1F);
  EXPECT_EQ(kinds(), 1);
  problem.grid.planck[1] = 1.5F;
  EXPECT_EQ(kinds(), 2);
  problem.grid.planck_step[6] = 0;
  EXPECT_EQ(kinds(), 3);
  problem.surface.planck_map = {1, 1, 1, 2};
  EXPECT_EQ(kinds(), 4);
  problem.surface.planck_map = {1, 1, 1, 1};
  EXPECT_EQ(kinds(), 3);
}

TEST(ColumnEmission, MatterAtZeroKelvinIsDark) {
  Problem problem = column_of({{2, .5, PhaseFunction::isotropic(), 0, 0}});
  const Solution s = solve_in(false, problem, by_columns());
  EXPECT_EQ(s.upwelling_flux[1], 0);
  EXPECT_EQ(s.ledger.power, 0);
  EXPECT_TRUE(s.report.converged);
}

}  // namespace
}  // namespace cloudbow
