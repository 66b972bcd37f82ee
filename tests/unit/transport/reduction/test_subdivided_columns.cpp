// Columns of thick voxels in parts.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "cloudbow/transport/solver.hpp"
#include "transport/reduction/subdivided_columns.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

Problem cloud(double extinction, double mu0 = .5, double azimuth_deg = 0) {
  BoxGrid box = make_box(4, 3, 3);
  box.dx_m = 6;
  box.dy_m = 2;
  box.x_min_m = 10;
  Problem problem;
  problem.grid = make_grid(box, random_extinction(box, extinction, 5), .99);
  problem.phase = {PhaseFunction::henyey_greenstein(.7)};
  problem.sun = Sun{travel_along(-mu0, azimuth_deg), 1.};
  problem.surface.albedo_map.resize(12);
  for (std::size_t c = 0; c < 12; ++c) problem.surface.albedo_map[c] = static_cast<float>(.05 * static_cast<double>(c));
  return problem;
}

// One extinction everywhere. Its delta-M scaled depth is `depth` across one column of width 1.
Problem slab(double depth, int nx, int ny, double azimuth_deg) {
  Problem problem = cloud(1, .5, azimuth_deg);
  const BoxGrid box = make_box(nx, ny, 3);
  const double extinction = depth / (.01 + .99 * (1 - std::pow(.7, coarse_options().fit.delta_m_order)));
  problem.grid = make_grid(box, std::vector<float>(cells_of(box), static_cast<float>(extinction)), .99);
  problem.surface = {};
  return problem;
}

SubdividedColumns parts_of(const Problem& problem, double largest, int most = 3) {
  SolverOptions options = coarse_options();
  options.max_column_optical_depth = largest;
  options.max_column_parts = most;
  return subdivide_thick_columns(problem, options);
}

TEST(SubdividedColumns, AsManyPartsAsTheDepthAsksFor) {
  EXPECT_EQ(parts_of(slab(.9, 4, 4, 0), 1), (SubdividedColumns{1, 1}));
  EXPECT_EQ(parts_of(slab(1.9, 4, 4, 0), 1), (SubdividedColumns{2, 1})) << "twice the depth across the sun's azimuth";
  EXPECT_EQ(parts_of(slab(1.9, 4, 4, 90), 1), (SubdividedColumns{1, 2}));
  EXPECT_EQ(parts_of(slab(2.9, 4, 4, 180), 1), (SubdividedColumns{3, 2}));
  EXPECT_EQ(parts_of(slab(2.9, 4, 4, 45), 1), (SubdividedColumns{2, 2}));
  EXPECT_EQ(parts_of(slab(99, 4, 4, 0), 1), (SubdividedColumns{3, 3})) << "no more";
  EXPECT_EQ(parts_of(slab(4.5, 4, 4, 0), 1, 16), (SubdividedColumns{5, 3}));
  EXPECT_EQ(parts_of(slab(4.5, 4, 4, 0), 1, 4), (SubdividedColumns{4, 3}));
  EXPECT_EQ(parts_of(slab(2.9, 4, 1, 0), 1), (SubdividedColumns{3, 1})) << "nothing varies along one column";
  EXPECT_EQ(parts_of(slab(2.9, 4, 4, 0), 0), (SubdividedColumns{1, 1}));
  Problem dark = slab(2.9, 4, 4, 0);
  dark.sun.reset();
  EXPECT_EQ(parts_of(dark, 1), (SubdividedColumns{1, 1}));
  SolverOptions options = coarse_options();
  options.max_column_optical_depth = 1;
  options.independent_columns = true;
  EXPECT_FALSE(subdivide_thick_columns(slab(2.9, 4, 4, 0), options).any());
}

TEST(SubdividedColumns, HoldTheSameMatterAndSurface) {
  const Problem whole = cloud(2);
  const Problem fine = with_subdivided_columns(whole, {3, 2});
  EXPECT_EQ(fine.grid.box.nx, 12);
  EXPECT_EQ(fine.grid.box.ny, 6);
  EXPECT_DOUBLE_EQ(fine.grid.box.dx_m, 2);
  EXPECT_DOUBLE_EQ(fine.grid.box.dy_m, 1);
  EXPECT_DOUBLE_EQ(fine.grid.box.x_min_m, 10);
  EXPECT_EQ(fine.grid.active_cells(), 6 * whole.grid.active_cells());
  const auto sum = [](const Problem& of) {
    return std::accumulate(of.grid.scattering[0].begin(), of.grid.scattering[0].end(), 0.);
  };
  EXPECT_NEAR(sum(fine) / 6 / sum(whole), 1, 1e-6);
  EXPECT_FLOAT_EQ(fine.surface.albedo_map[5 * 12 + 11], whole.surface.albedo_map[11]);
  EXPECT_FLOAT_EQ(fine.surface.albedo_map[2 * 12 + 5], whole.surface.albedo_map[5]);
}

TEST(SubdividedColumns, ResultIsTheMeanOverThePartsOfTheFineProblem) {
  const Problem whole = cloud(2);
  SolverOptions options = coarse_options();
  options.actinic = options.radiance_field = true;
  options.views.push_back({"nadir", Direction(0, 0, 1), 0, 0});
  options.views.push_back({"pixels", Direction(0, 0, 1), 5, 4});
  const Solution fine = solve(with_subdivided_columns(whole, {3, 2}), options);
  options.max_column_optical_depth = 1e-9;  // as many parts as there may be
  const Solution most = solve(whole, options);
  EXPECT_EQ(most.report.column_parts_x, 3);
  EXPECT_EQ(most.report.column_parts_y, 3);
  EXPECT_EQ(most.box.nx, 4);
  EXPECT_EQ(most.upwelling_flux.size(), 4 * 12U);
  EXPECT_EQ(most.absorbed_power.size(), 36U);
  EXPECT_EQ(most.images[0].radiance.size(), 12U);
  EXPECT_EQ(most.images[1].radiance.size(), 20U);
  EXPECT_EQ(most.radiance_field->voxel.size(), 36U) << "with actinic flux all cells have light";

  Solution joined = fine;
  join_columns(whole, {3, 2}, joined);
  EXPECT_EQ(joined.report.active_voxels, whole.grid.active_cells());
  ASSERT_EQ(joined.upwelling_flux.size(), 4 * 12U);
  double mean = 0;  // of the parts of column (2, 1) at the top
  for (std::size_t b = 0; b < 2; ++b) {
    for (std::size_t a = 0; a < 3; ++a)
      mean += static_cast<double>(fine.upwelling_flux[3 * 72 + (2 + b) * 12 + 6 + a]) / 6;
  }
  EXPECT_NEAR(joined.upwelling_flux[3 * 12 + 6], mean, 1e-6);
  // Energy: absorption summed over cells is that of the ledger.
  for (const Solution* const solution : {static_cast<const Solution*>(&joined), &most}) {
    const double absorbed = std::accumulate(solution->absorbed_power.begin(), solution->absorbed_power.end(), 0.) / 12;
    EXPECT_NEAR(absorbed / .5, solution->ledger.absorptance, 1e-5);
  }
  // Voxels come in the order of cells, and their radiance is a mean.
  EXPECT_EQ(joined.radiance_field->voxel, most.radiance_field->voxel);
  EXPECT_EQ(joined.radiance_field->radiance.size(), most.radiance_field->radiance.size());
}

}  // namespace
}  // namespace cloudbow
