// Columns solved without azimuths and without iteration. Truth: Beer's law, furnaces, discrete ordinates (cdisort),
// invariance under cutting a layer, and the solver of ordinates.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "cloudbow/transport/solver.hpp"
#include "transport/columns/columns.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

SolverOptions by_independent_columns(int streams = 8) {
  SolverOptions options;
  options.independent_columns = true;
  options.column_streams = streams;
  options.tolerance = 1e-5;
  return options;
}

Problem problem_of(OpticalGrid grid, const PhaseFunction& phase, double mu0 = .6) {
  Problem problem;
  problem.grid = std::move(grid);
  problem.phase = {phase};
  problem.sun = Sun{travel_along(-mu0, 37), 1.};
  return problem;
}

// One column of `cells` like cells.
Problem slab(double optical_depth, double single_scattering_albedo, const PhaseFunction& phase, double mu0,
             int cells = 1) {
  const BoxGrid box = make_box(1, 1, cells);
  return problem_of(
      make_grid(box, std::vector<float>(cells, static_cast<float>(optical_depth / cells)), single_scattering_albedo),
      phase, mu0);
}

Problem random_columns(bool periodic, double largest, double single_scattering_albedo, double surface_albedo) {
  const BoxGrid box = make_box(6, 5, 7, periodic);
  Problem problem = problem_of(make_grid(box, random_extinction(box, largest, 3), single_scattering_albedo),
                               PhaseFunction::henyey_greenstein(.85));
  problem.surface.albedo = surface_albedo;
  return problem;
}

void expect_same_bits(const Solution& one, const Solution& two) {
  EXPECT_EQ(one.upwelling_flux, two.upwelling_flux);
  EXPECT_EQ(one.downwelling_diffuse_flux, two.downwelling_diffuse_flux);
  EXPECT_EQ(one.direct_flux, two.direct_flux);
  EXPECT_EQ(one.absorbed_power, two.absorbed_power);
  EXPECT_EQ(one.ledger.residual, two.ledger.residual);
  EXPECT_EQ(one.report.estimated_error, two.report.estimated_error);
}

TEST(Columns, PureAbsorptionIsBeersLaw) {
  const Solution solution = solve(slab(3, 0, PhaseFunction::isotropic(), .5, 4), by_independent_columns());
  for (int e = 0; e <= 4; ++e) {
    // Float has 1e-7.
    EXPECT_NEAR(solution.direct_flux[e], .5 * std::exp(-(4 - e) * .75 / .5), 1e-7);
    EXPECT_NEAR(solution.upwelling_flux[e], 0, 1e-7);
    EXPECT_NEAR(solution.downwelling_diffuse_flux[e], 0, 1e-7);
  }
  EXPECT_NEAR(solution.ledger.absorptance, 1 - std::exp(-6), 1e-6);
}

struct SlabCase {
  double optical_depth, single_scattering_albedo, g, mu0;
  double up, down;  // at the top; at the bottom, direct and diffuse
};

TEST(Columns, SlabsHaveTheFluxesOfDiscreteOrdinates) {
  // cdisort 2.1.3 with 128 streams (tests/data/plane_parallel_subset.json).
  const SlabCase cases[] = {
      {0.03125, 0.2, 0, 0.1, 0.002542400254, 0.0756876256},
      {0.03125, 1, 0, 0.5, 0.01515605547, 0.4848439445},
      {1, 0.99, 0, 0.5, 0.243259161, 0.2458138516},
      {32, 0.2, 0, 0.5, 0.02542738272, 1.003560364e-16},
      {32, 1, 0, 1, 0.949767194, 0.05023280595},
      {8, 1, 0.75, 0.5, 0.3309536427, 0.1690463574},
      {0.1, 0.999, 0.85, 1, 0.003706314078, 0.9961912269},
      {1, 0.999, 0.85, 0.5, 0.08210418097, 0.416679471},
      {5, 0.999, 0.85, 0.1, 0.07065262694, 0.02852730179},
      {10, 1, 0.85, 1, 0.4222748565, 0.5777251441},
      {20, 1, 0.85, 0.5, 0.3692092131, 0.1307907869},
      {20, 0.9, 0.85, 1, 0.1038590856, 0.01229274177},
      {50, 0.999, 0.85, 1, 0.7453050737, 0.148644142},
      {100, 1, 0.85, 0.1, 0.09620708676, 0.003792913238},
      {100, 0.9, 0.85, 0.1, 0.04487137247, 1.37462864e-12},
  };
  for (const SlabCase& c : cases) {
    const PhaseFunction phase = c.g > 0 ? PhaseFunction::henyey_greenstein(c.g) : PhaseFunction::isotropic();
    for (const int cells : {1, 20}) {
      const Solution solution =
          solve(slab(c.optical_depth, c.single_scattering_albedo, phase, c.mu0, cells), by_independent_columns(16));
      // Sixteen streams per hemisphere are accurate to 1e-5 of the incident flux in these cases; float in deep columns
      // to 1e-5.
      EXPECT_NEAR(solution.upwelling_flux.back(), c.up, 1e-4 * c.mu0) << c.optical_depth << " " << c.mu0;
      EXPECT_NEAR(solution.downwelling_diffuse_flux[0] + solution.direct_flux[0], c.down, 1e-4 * c.mu0)
          << c.optical_depth << " " << c.mu0;
    }
  }
}

TEST(Columns, GrazingSunsOnStrongPeaksHaveTheFluxesOfAddingAndDoubling) {
  // tests/reference/plane_parallel with 160 angles, accurate to 2e-7.
  const SlabCase cases[] = {
      {114, .9, .98, .062, .01570826869, 4.02e-10},
      {12.7, .9, .97, .056, .01804157626, .0007502182998},
      {50, .999, .95, .05, .04267094499, .005279294407},
  };
  for (const SlabCase& c : cases) {
    const Solution solution =
        solve(slab(c.optical_depth, c.single_scattering_albedo, PhaseFunction::henyey_greenstein(c.g), c.mu0),
              by_independent_columns(8));
    // Eight streams are accurate to .03 % of the incident flux here. A beam truncated at 32 moments errs by up to .3 %.
    EXPECT_NEAR(solution.upwelling_flux.back(), c.up, 3e-4 * c.mu0) << c.g;
    EXPECT_NEAR(solution.downwelling_diffuse_flux[0] + solution.direct_flux[0], c.down, 3e-4 * c.mu0) << c.g;
  }
}

TEST(Columns, ConservativeSlabsOfAnyDepthLoseNothing) {
  for (const double depth : {1e-4, .01, 1., 30., 100., 1e4}) {
    for (const int cells : {1, 40}) {
      Problem problem = slab(depth, 1, PhaseFunction::henyey_greenstein(.85), .5, cells);
      problem.surface.albedo = .3;
      const Solution solution = solve(problem, by_independent_columns());
      EXPECT_TRUE(solution.report.converged) << depth;
      EXPECT_LT(std::abs(solution.ledger.residual), 1e-5) << depth;
      EXPECT_EQ(solution.ledger.absorptance, 0);
      EXPECT_EQ(solution.report.sweeps, 1);
    }
  }
}

TEST(Columns, WhatAVeryThickSlabLetsThroughHasItsDigits) {
  // Isotropic scattering without absorption under an overhead sun: T = H(1)/sqrt(3) / (depth + 2 q), H(1) = 2.90781,
  // q = .710446 (Chandrasekhar 1950); 16 streams are good to 1e-4 of it. In double and in float, as one cell and as
  // many.
  for (const double depth : {1e3, 1e5, 1e8, 1e9, 1e12, 1e20, 1e30}) {
    for (const int cells : {1, 7, 40}) {
      for (const bool in_double : {true, false}) {
        SolverOptions options = by_independent_columns(16);
        options.double_precision = in_double;
        options.collapse_uniform_axes = false;
        const Solution solution = solve(slab(depth, 1, PhaseFunction::isotropic(), 1, cells), options);
        EXPECT_NEAR(solution.downwelling_diffuse_flux[0] * (depth + 1.420892), 2.90781 / std::sqrt(3.), 3e-4)
            << depth << " " << cells << " " << in_double;
        EXPECT_LT(std::abs(solution.ledger.residual), in_double ? 1e-12 : 1e-5) << depth << " " << cells;
      }
    }
  }
}

TEST(Columns, FurnaceStaysAtTheSkysRadiance) {
  Problem problem = random_columns(true, 5, 1, 1);
  problem.sun.reset();
  problem.sky_radiance = 1;
  SolverOptions options = by_independent_columns();
  options.actinic = true;
  const Solution solution = solve(problem, options);
  // A white ground under matter that does not absorb: 1 everywhere, to float.
  for (const float f : solution.upwelling_flux) EXPECT_NEAR(f, pi, 2e-5);
  for (const float f : solution.downwelling_diffuse_flux) EXPECT_NEAR(f, pi, 2e-5);
  for (const float f : solution.actinic_flux) EXPECT_NEAR(f, 4 * pi, 1e-4);
}

TEST(Columns, CuttingALayerChangesNothing) {
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(.85);
  for (const double mu0 : {.05, .3, 1.}) {
    const Solution whole = solve(slab(4, .97, phase, mu0), by_independent_columns());
    const Solution cut = solve(slab(4, .97, phase, mu0, 16), by_independent_columns());
    // Each cell is exact but for its thinnest part.
    EXPECT_NEAR(whole.upwelling_flux.back(), cut.upwelling_flux.back(), 2e-4 * mu0);
    EXPECT_NEAR(whole.downwelling_diffuse_flux[0], cut.downwelling_diffuse_flux[0], 2e-4 * mu0);
    EXPECT_NEAR(whole.ledger.absorptance, cut.ledger.absorptance, 2e-4);
  }
}

TEST(Columns, AreColumnsSolvedOneByOne) {
  Problem problem = random_columns(true, 4, .99, .4);
  const BoxGrid box = problem.grid.box;
  const auto extinction = random_extinction(box, 4, 3);
  SolverOptions options = by_independent_columns();
  options.actinic = true;
  const Solution together = solve(problem, options);
  EXPECT_EQ(together.report.mode, "independent-columns");
  for (std::size_t column = 0; column < box.columns(); ++column) {
    std::vector<float> own;
    for (int k = 0; k < box.nz(); ++k) own.push_back(extinction[k * box.columns() + column]);
    problem.grid = make_grid(make_box(1, 1, box.nz()), own, .99);
    const Solution alone = solve(problem, options);
    for (int e = 0; e <= box.nz(); ++e) {  // neighbours in a batch share the number of doublings
      const std::size_t at = e * box.columns() + column;
      EXPECT_NEAR(together.upwelling_flux[at], alone.upwelling_flux[e], 1e-4);
      EXPECT_NEAR(together.downwelling_diffuse_flux[at], alone.downwelling_diffuse_flux[e], 1e-4);
      EXPECT_NEAR(together.direct_flux[at], alone.direct_flux[e], 1e-6);
      if (e == box.nz()) continue;
      EXPECT_NEAR(together.actinic_flux[at], alone.actinic_flux[e], 1e-3);
    }
  }
}

TEST(Columns, LikeColumnsHaveTheSameBitsWhateverElseThereIs) {
  const BoxGrid box = make_box(8, 3, 5);
  std::vector<float> extinction = random_extinction(box, 6, 9);
  for (int k = 0; k < 5; ++k) {
    for (int j = 0; j < 3; ++j) extinction[(k * 3 + j) * 8 + 7] = extinction[(k * 3) * 8];
  }
  const Problem problem = problem_of(make_grid(box, extinction, .98), PhaseFunction::henyey_greenstein(.8));
  const Solution solution = solve(problem, by_independent_columns(4));
  for (int e = 0; e <= 5; ++e) {
    const float first = solution.upwelling_flux[e * 24];
    for (int j = 0; j < 3; ++j) EXPECT_EQ(solution.upwelling_flux[e * 24 + j * 8 + 7], first);
  }
  EXPECT_NE(solution.upwelling_flux[5 * 24 + 1], solution.upwelling_flux[5 * 24]);
}

TEST(Columns, AlbedoMapsTellColumnsApart) {
  const BoxGrid box = make_box(2, 1, 1);
  Problem problem = problem_of(make_grid(box, std::vector<float>(2, 1.F), 1), PhaseFunction::isotropic());
  problem.surface.albedo_map = {.1F, .7F};
  const Solution both = solve(problem, by_independent_columns());
  for (int c = 0; c < 2; ++c) {
    Problem one = problem;
    one.surface.albedo = static_cast<double>(problem.surface.albedo_map[c]);
    one.surface.albedo_map.clear();
    EXPECT_NEAR(both.upwelling_flux[2 + c], solve(one, by_independent_columns()).upwelling_flux[2], 1e-6);
  }
}

TEST(Columns, BitsDoNotDependOnThreads) {
  const Problem problem = random_columns(true, 6, .99, .2);
  SolverOptions options = by_independent_columns(4);
  options.threads = 1;
  const Solution one = solve(problem, options);
  options.threads = 2;
  expect_same_bits(one, solve(problem, options));
}

TEST(Columns, AbsorbedPowerIsActinicFluxTimesAbsorption) {
  const Problem problem = random_columns(false, 3, .9, .2);
  SolverOptions options = by_independent_columns(4);
  options.actinic = true;
  const Solution solution = solve(problem, options);
  const auto extinction = random_extinction(problem.grid.box, 3, 3);
  for (std::size_t c = 0; c < extinction.size(); ++c) {
    const double absorption = .1 * static_cast<double>(extinction[c]);
    EXPECT_NEAR(solution.absorbed_power[c], absorption * static_cast<double>(solution.actinic_flux[c]), 1e-6);
  }
  EXPECT_LT(std::abs(solution.ledger.residual), 1e-5);
}

TEST(Columns, HaveTheFluxesOfOrdinates) {
  Problem problem = random_columns(true, 2, .99, .3);
  SolverOptions options = by_independent_columns(16);
  const Solution columns = solve(problem, options);
  options.views = {{"up", Direction::UnitZ(), 0, 0}};  // requests azimuths
  options.directions = "double-gauss-12x24";
  options.fit.delta_m_order = 10;
  options.fit.beam_delta_m_order = 14;
  options.control_points = 162;
  EXPECT_FALSE(solved_by_polar_streams(problem, options));
  const Solution ordinates = solve(problem, options);
  double squares = 0, mean = 0;
  for (std::size_t c = 0; c < 30; ++c) {
    const double up = static_cast<double>(ordinates.upwelling_flux[7 * 30 + c]);
    squares += std::pow(static_cast<double>(columns.upwelling_flux[7 * 30 + c]) - up, 2) / 30;
    mean += up / 30;
  }
  // Cells of optical depth 2, for which sources linear in the cell have an error of half a per cent.
  EXPECT_LT(std::sqrt(squares) / mean, .01);
}

TEST(Columns, DiffuseColumnsUnderASlantedBeamKeepEnergy) {
  for (const bool periodic : {true, false}) {
    const Problem problem = random_columns(periodic, 2, .97, .3);
    SolverOptions options = by_independent_columns();
    options.beam_crosses_columns = true;
    options.actinic = true;
    const Solution solution = solve(problem, options);
    EXPECT_EQ(solution.report.mode, "independent-diffuse");
    EXPECT_LT(std::abs(solution.ledger.residual), 1e-5);
    EXPECT_EQ(solution.ledger.side_gain > 0, !periodic);
    // The beam comes from the side: its flux on the ground is that of the beam in three dimensions.
    options.beam_crosses_columns = false;
    EXPECT_NE(solve(problem, options).direct_flux, solution.direct_flux);
  }
}

TEST(Columns, ShadowsThatPassBetweenLevelsTellColumnsApart) {
  // The shadow of a thin black voxel moves by 5.9 columns on its way to the ground: it crosses columns whose faces it
  // does not touch.
  BoxGrid box = make_box(12, 1, 2);
  box.z_edge_m = {0, 1.2, 1.3};
  std::vector<float> extinction(24, 0.F);
  extinction[12] = 1000;
  Problem problem = problem_of(make_grid(box, extinction, 0), PhaseFunction::isotropic());
  problem.sun->travel = travel_along(-.2, 0);
  SolverOptions options = by_independent_columns();
  options.beam_crosses_columns = true;
  options.actinic = true;
  const Solution solution = solve(problem, options);
  // Light that crosses the level between them goes through the empty cells below, at the sun's slant.
  double actinic = 0, direct = 0;
  for (std::size_t c = 0; c < 12; ++c) {
    actinic += static_cast<double>(solution.actinic_flux[c]) / 12;
    direct += static_cast<double>(solution.direct_flux[12 + c]) / 12;
  }
  EXPECT_NEAR(actinic, direct / .2, 1e-5);  // in float
  EXPECT_LT(solution.actinic_flux[3], .9F * solution.actinic_flux[10]);
}

TEST(Columns, ASlantedBeamThroughASlabIsThatOfItsColumns) {
  const BoxGrid box = make_box(3, 2, 40);
  const Problem problem = problem_of(make_grid(box, std::vector<float>(cells_of(box), .05F), .99),
                                     PhaseFunction::henyey_greenstein(.85), .5);
  SolverOptions options = by_independent_columns();
  const Solution columns = solve(problem, options);
  options.beam_crosses_columns = true;
  const Solution slanted = solve(problem, options);
  // Sources are the same all over a cell there: of second order in its optical depth, .1 on the slant.
  EXPECT_NEAR(slanted.upwelling_flux.back(), columns.upwelling_flux.back(), 2e-4);
  EXPECT_NEAR(slanted.downwelling_diffuse_flux[0], columns.downwelling_diffuse_flux[0], 2e-4);
  EXPECT_NEAR(slanted.direct_flux[0], columns.direct_flux[0], 1e-6);
}

}  // namespace
}  // namespace cloudbow
