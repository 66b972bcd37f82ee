// Layers beside clouds, in blocks. Truth: the same matter in the voxels' own cells, and in one column.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "cloudbow/medium/grid_map.hpp"
#include "cloudbow/transport/solver.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

Problem problem_of(OpticalGrid grid, double mu0 = .6) {
  Problem problem;
  problem.grid = std::move(grid);
  problem.phase = {PhaseFunction::henyey_greenstein(.85), PhaseFunction::rayleigh()};
  problem.sun = Sun{travel_along(-mu0, 37), 1.};
  problem.surface.albedo = .3;
  return problem;
}

Problem with_own_cells(const Problem& problem) {
  Problem other = problem;
  other.grid = without_air_blocks(problem.grid);
  return other;
}

SolverOptions options_for_fluxes() {
  SolverOptions options = coarse_options();
  options.flux_levels = FluxLevels::all;
  options.tolerance = 1e-6;
  options.double_precision = true;
  return options;
}

// 6 x 4 columns, clouds in the levels 2 and 3 of 6; the levels above are higher than wide.
BoxGrid box_of_six_levels(bool periodic = true) {
  BoxGrid box = make_box(6, 4, 0, periodic);
  box.z_edge_m = {0, 1, 2, 3, 4, 9, 40};
  return box;
}

// Every third voxel of their levels is clear. @param sparse four in five are.
std::vector<float> clouds(const BoxGrid& box, unsigned seed = 3, bool sparse = false) {
  std::vector<float> extinction = random_extinction(box, 3, seed);
  for (std::size_t c = 0; c < extinction.size(); ++c) {
    const std::size_t k = c / box.columns();
    if (k < 2 || k > 3 || (sparse ? c % 5 != 0 : c % 3 == 0)) extinction[c] = 0;
  }
  return extinction;
}

const Layers air{{.01, .02, .02, .01, .004, .001}, {.1, .1, .05, .05, .02, .004}};

double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t c = 0; c < std::min(a.size(), b.size()); ++c)
    largest = std::max(largest, std::abs(static_cast<double>(a[c]) - static_cast<double>(b[c])));
  return largest;
}

double largest_difference(const Solution& a, const Solution& b) {
  return std::max({largest_difference(a.upwelling_flux, b.upwelling_flux),
                   largest_difference(a.downwelling_diffuse_flux, b.downwelling_diffuse_flux),
                   largest_difference(a.direct_flux, b.direct_flux)});
}

TEST(Air, BlocksOfOneColumnAreTheVoxelsOwnCells) {
  // The same problem, but for the kernel that crosses a cell: with a source constant in each cell nothing else differs.
  for (const bool periodic : {true, false}) {
    const BoxGrid box = box_of_six_levels(periodic);
    const Problem problem = problem_of(grid_in_blocks(box, clouds(box), air, 1));
    SolverOptions options = options_for_fluxes();
    options.linear_source = false;
    options.views = {{"up", travel_along(.8, 20), 0, 0}, {"pixels", travel_along(.5, 200), 12, 8}};
    const Solution in_blocks = solve(problem, options);
    const Solution own = solve(with_own_cells(problem), options);
    EXPECT_TRUE(in_blocks.report.converged);
    EXPECT_LE(largest_difference(in_blocks, own), 1e-5) << (periodic ? "periodic" : "open");
    EXPECT_LE(largest_difference(in_blocks.absorbed_power, own.absorbed_power), 1e-6);
    for (std::size_t v = 0; v < 2; ++v)
      EXPECT_LE(largest_difference(in_blocks.images[v].radiance, own.images[v].radiance), 1e-5) << v;
  }
}

TEST(Air, AbsorptionIsExactInBlocksOfAnyWidth) {
  const BoxGrid box = box_of_six_levels();
  const Layers gas{{.01, .02, .2, .01, .004, .001}, std::vector<double>(6, 0.)};
  SolverOptions options = options_for_fluxes();
  options.linear_source = false;
  const Solution whole = solve(problem_of(grid_in_blocks(box, clouds(box), gas, 0)), options);
  const Solution own = solve(with_own_cells(problem_of(grid_in_blocks(box, clouds(box), gas, 1))), options);
  EXPECT_LE(largest_difference(whole, own), 1e-5);
  EXPECT_NEAR(whole.ledger.absorptance, own.ledger.absorptance, 1e-6);
  EXPECT_LE(std::abs(whole.ledger.residual), 1e-6);
}

TEST(Air, AbsorptionByVoxelIsThatOfOwnCells) {
  // The levels 0 to 3 reach up to the clouds; above, blocks are not resolved. The source is constant in each cell. Then
  // light in voxels differs by the source at the ordinates alone, which is interpolated from the control points.
  const BoxGrid box = box_of_six_levels();
  const Layers gas{{.01, .02, .02, .01, .004, .001}, std::vector<double>(6, 0.)};
  const Problem problem = problem_of(grid_in_blocks(box, clouds(box), gas, 0));
  SolverOptions options;
  options.flux_levels = FluxLevels::boundaries;
  options.linear_source = false;
  const std::vector<float> in_blocks = solve(problem, options).absorbed_power;
  const std::vector<float> own = solve(with_own_cells(problem), options).absorbed_power;
  for (std::size_t k = 0; k < 6; ++k) {
    double mean = 0, difference = 0, squares = 0, variation = 0;
    const auto of_level = [&](const std::vector<float>& field, std::size_t c) {
      return static_cast<double>(field[k * box.columns() + c]) / static_cast<double>(box.columns());
    };
    for (std::size_t c = 0; c < box.columns(); ++c) mean += of_level(own, c);
    for (std::size_t c = 0; c < box.columns(); ++c) {
      difference += of_level(in_blocks, c) - of_level(own, c);
      squares += std::pow(of_level(in_blocks, c) - of_level(own, c), 2);
      variation += std::pow(of_level(own, c) - mean / static_cast<double>(box.columns()), 2);
    }
    EXPECT_NEAR(difference / mean, 0, .002) << k;
    if (k < 4) {
      EXPECT_LT(std::sqrt(squares), .05 * std::sqrt(variation)) << k;
    }
  }
}

TEST(Air, LayersAloneInColumnsAreOneColumn) {
  const BoxGrid box = box_of_six_levels();
  const std::vector<float> no_cloud(cells_of(box), 0.F);
  for (const int columns : {0, 2}) {
    const Problem problem = problem_of(grid_in_blocks(box, no_cloud, air, columns));
    const SolverOptions options = options_for_fluxes();
    const Solution field = solve(problem, options);
    Problem column = problem;
    column.grid = layers_only(problem.grid);
    const Solution one = solve(column, options);
    EXPECT_TRUE(field.report.converged);
    for (std::size_t e = 0; e < one.profile_upwelling_flux.size(); ++e) {
      EXPECT_NEAR(field.profile_upwelling_flux[e], one.profile_upwelling_flux[e], 1e-5 * .6) << columns << " " << e;
      EXPECT_NEAR(field.profile_downwelling_diffuse_flux[e], one.profile_downwelling_diffuse_flux[e], 1e-5 * .6) << e;
      EXPECT_NEAR(field.profile_direct_flux[e], one.profile_direct_flux[e], 1e-6) << e;
    }
  }
}

TEST(Air, EnergyClosesAndMeansAreThoseOfOwnCells) {
  // Light that the air scatters is that of the block's mean: domain means differ by what light varies in between.
  for (const bool periodic : {true, false}) {
    for (const int columns : {0, -1, 4, 2}) {  // -1: one block, and sparse clouds
      const BoxGrid box = box_of_six_levels(periodic);
      const std::vector<float> cloud = clouds(box, 3, columns < 0);
      const Problem problem = problem_of(grid_in_blocks(box, cloud, air, std::max(columns, 0)));
      const SolverOptions options = options_for_fluxes();
      const Solution in_blocks = solve(problem, options);
      const Solution own = solve(with_own_cells(problem), options);
      EXPECT_TRUE(in_blocks.report.converged);
      EXPECT_LE(std::abs(in_blocks.ledger.residual), 1e-6);
      EXPECT_LT(in_blocks.report.active_voxels, own.report.active_voxels);
      EXPECT_NEAR(in_blocks.ledger.reflectance, own.ledger.reflectance, periodic ? .003 : .01) << columns;
      EXPECT_NEAR(in_blocks.ledger.transmittance, own.ledger.transmittance, periodic ? .003 : .01) << columns;
      EXPECT_NEAR(in_blocks.ledger.absorptance, own.ledger.absorptance, periodic ? .003 : .01) << columns;
    }
  }
}

TEST(Air, SameBitsForAnyNumberOfThreads) {
  BoxGrid box = make_box(24, 24, 14);  // more cells than are worth threads
  box.z_edge_m.push_back(60);
  std::vector<float> cloud = random_extinction(box, 1, 5);
  for (std::size_t c = 14 * box.columns(); c < cloud.size(); ++c) cloud[c] = 0;
  const Layers layers{std::vector<double>(15, .001), std::vector<double>(15, .01)};
  for (const int columns : {0, 8}) {
    const Problem problem = problem_of(grid_in_blocks(box, cloud, layers, columns));
    SolverOptions options = coarse_options();
    options.threads = 1;
    const Solution one = solve(problem, options);
    for (const int threads : {2, 3, 5}) {
      options.threads = threads;
      const Solution many = solve(problem, options);
      EXPECT_EQ(many.report.threads, threads);
      EXPECT_EQ(one.upwelling_flux, many.upwelling_flux) << threads;
      EXPECT_EQ(one.downwelling_diffuse_flux, many.downwelling_diffuse_flux) << threads;
      EXPECT_EQ(one.absorbed_power, many.absorbed_power) << threads;
    }
  }
}

TEST(Air, DenormalExtinctionAndLightAreNothing) {
  // Float holds 1e-40 below its normal range; the light behind an optical path of 90 is there too.
  const BoxGrid box = box_of_six_levels();
  const Layers gas{{1e-40, 0, 0, 0, 0, 3.}, {1e-40, 0, 0, 0, 0, 0}};
  const Solution solution = solve(problem_of(grid_in_blocks(box, clouds(box), gas, 0)), coarse_options());
  EXPECT_TRUE(solution.report.converged);
  EXPECT_NEAR(solution.ledger.absorptance, 1, 1e-6);
  for (const float flux : solution.upwelling_flux) EXPECT_TRUE(std::isfinite(flux));
}

TEST(Air, IndependentColumnsTakeTheVoxelsOwnCells) {
  const BoxGrid box = box_of_six_levels();
  const Problem problem = problem_of(grid_in_blocks(box, clouds(box), air, 0));
  SolverOptions options = options_for_fluxes();
  options.independent_columns = true;
  EXPECT_EQ(largest_difference(solve(problem, options), solve(with_own_cells(problem), options)), 0);
}

TEST(Air, PartsOfColumnsAndLevelsKeepTheBlocks) {
  const BoxGrid box = box_of_six_levels();
  const Problem problem = problem_of(grid_in_blocks(box, clouds(box), air, 2), .3);
  SolverOptions options = options_for_fluxes();
  options.max_column_optical_depth = .2;
  options.max_level_optical_depth = .2;
  const SolvePlan plan(problem, options);
  ASSERT_TRUE(plan.column_parts().any());
  ASSERT_GT(plan.added_levels(), 0);
  const OpticalGrid& parts = plan.problem().grid;
  ASSERT_FALSE(parts.air.empty());
  EXPECT_EQ(parts.air[0].width_x, 2 * plan.column_parts().x);
  const Solution in_blocks = solve(problem, options);
  const Solution own = solve(with_own_cells(problem), options);
  EXPECT_LE(std::abs(in_blocks.ledger.residual), 1e-6);
  EXPECT_NEAR(in_blocks.ledger.reflectance, own.ledger.reflectance, .003);
}

}  // namespace
}  // namespace cloudbow
