// Cells in which the beam fades. The truth is the same medium in thin cells.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "cloudbow/transport/solver.hpp"
#include "transport/reduction/subdivided_levels.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

// 3 x 2 columns; levels of 1 m are thin below and as thick as given above.
Problem thick_top(double extinction_of_top, double mu0) {
  const BoxGrid box = make_box(3, 2, 4);
  std::vector<float> extinction = random_extinction(box, .3, 5, true);
  const std::size_t columns = box.columns();
  for (std::size_t c = 0; c < columns; ++c) extinction[3 * columns + c] = static_cast<float>(extinction_of_top);
  Problem problem;
  problem.grid = make_grid(box, extinction, .99);
  problem.phase = {PhaseFunction::henyey_greenstein(.7)};
  problem.sun = Sun{travel_along(-mu0, 20), 1.};
  problem.surface.albedo = .2;
  return problem;
}

TEST(ThickLevels, ThinOnesDarkOnesAndThoseWithoutSunStayWhole) {
  SolverOptions options = coarse_options();
  options.max_level_optical_depth = 1;
  EXPECT_EQ(subdivide_thick_levels(thick_top(.3, .6), options).added(make_box(3, 2, 4)), 0);
  Problem dark = thick_top(20, .6);  // the thick part lies below the part that has absorbed the light
  for (float& s : dark.grid.scattering[0]) s = 20;
  const SubdividedLevels cut = subdivide_thick_levels(dark, options);
  EXPECT_GT(cut.added(dark.grid.box), 0);
  EXPECT_EQ(cut.level.front(), 0);
  EXPECT_EQ(cut.level[1], 1);
  EXPECT_EQ(cut.level[3], 3);
  dark.sun.reset();
  EXPECT_EQ(subdivide_thick_levels(dark, options).added(dark.grid.box), 0);
}

TEST(ThickLevels, PartsDoubleFromAbove) {
  const Problem problem = thick_top(20, .6);
  SolverOptions options = coarse_options();
  options.max_level_optical_depth = 1;
  const SubdividedLevels cut = subdivide_thick_levels(problem, options);
  ASSERT_GT(cut.added(problem.grid.box), 2);
  const std::size_t parts = cut.level.size();
  const auto thickness = [&](std::size_t part) { return cut.z_edge_m[part + 1] - cut.z_edge_m[part]; };
  // Scaled by delta-M (f = .7^6) and slant: 20 (.01 + .99 (1 - f)) / .6.
  const double depth = 20 * (.01 + .99 * (1 - std::pow(.7, 6))) / .6;
  EXPECT_NEAR(depth * thickness(parts - 1), 1, 1e-4);
  EXPECT_NEAR(thickness(parts - 2), 2 * thickness(parts - 1), 1e-9);
  EXPECT_DOUBLE_EQ(cut.z_edge_m.back(), 4);
  EXPECT_DOUBLE_EQ(cut.z_edge_m[3], 3);
}

// Equal parts make runs of levels of one thickness, which can be marched along x and y.
TEST(ThickLevels, TwoPartsAreEqualIfColumnsDiffer) {
  const double depth_of_1 = (.01 + .99 * (1 - std::pow(.7, 6))) / .6;  // of the extinction 1
  SolverOptions options = coarse_options();
  options.max_level_optical_depth = 1;
  const auto lowest_edge_of_top = [&](double extinction, bool columns_differ, bool independent) {
    Problem problem = thick_top(extinction / depth_of_1, .6);
    if (columns_differ) {
      std::vector<float> of_cells = random_extinction(problem.grid.box, .3, 5, true);
      for (std::size_t c = 0; c < 6; ++c)
        of_cells[18 + c] = static_cast<float>(extinction / depth_of_1 * (c == 0 ? 1.01 : .998));
      problem.grid = make_grid(problem.grid.box, of_cells, .99);
    }
    options.independent_columns = independent;
    const SubdividedLevels cut = subdivide_thick_levels(problem, options);
    EXPECT_EQ(cut.added(problem.grid.box), 1);
    return cut.z_edge_m[4];
  };
  EXPECT_DOUBLE_EQ(lowest_edge_of_top(1.6, true, false), 3.5);
  EXPECT_DOUBLE_EQ(lowest_edge_of_top(2.4, true, false), 3.5);
  EXPECT_NEAR(lowest_edge_of_top(2.6, true, false), 4 - 1 / 2.6, 1e-3) << "the first part would be too thick";
  EXPECT_NEAR(lowest_edge_of_top(2.4, false, false), 4 - 1 / 2.4, 1e-3) << "the same in all columns";
  EXPECT_NEAR(lowest_edge_of_top(2.4, true, true), 4 - 1 / 2.4, 1e-3) << "columns are marched along z";
}

TEST(ThickLevels, DarkOnesBesideClearColumnsHaveEqualParts) {
  Problem dark = thick_top(20, .6);
  for (float& s : dark.grid.scattering[0]) s = 20;
  SolverOptions options = coarse_options();
  options.max_level_optical_depth = 1;
  options.max_column_optical_depth = 8;  // in three parts of 20 (1 - .7^6)
  const SubdividedLevels closed = subdivide_thick_levels(dark, options);
  EXPECT_EQ(closed.level[1], 1) << "light has no way to the lowest level";
  const BoxGrid& box = dark.grid.box;
  std::vector<float> extinction(cells_of(box), 20.F);
  for (std::size_t k = 0; k < 4; ++k) extinction[k * box.columns()] = 0;  // a clear column
  dark.grid = make_grid(box, extinction, .99);
  const SubdividedLevels open = subdivide_thick_levels(dark, options);
  EXPECT_EQ(open.level[2], 0);
  EXPECT_EQ(open.level[3], 1);
  EXPECT_NEAR(open.z_edge_m[1], 1. / 3, 1e-12);
  options.max_column_optical_depth = 0;
  EXPECT_EQ(subdivide_thick_levels(dark, options).level[1], 1);
}

TEST(ThickLevels, TheResultHasTheLevelsAsTheyAre) {
  const Problem problem = thick_top(20, .6);
  SolverOptions options = coarse_options();
  options.actinic = options.radiance_field = true;
  const Solution plain = solve(problem, options);
  options.max_level_optical_depth = 1;
  const Solution cut = solve(problem, options);
  EXPECT_GT(cut.report.added_levels, 0);
  EXPECT_EQ(plain.report.added_levels, 0);
  EXPECT_EQ(cut.box.z_edge_m, plain.box.z_edge_m);
  EXPECT_EQ(cut.flux_level, plain.flux_level);
  EXPECT_EQ(cut.upwelling_flux.size(), plain.upwelling_flux.size());
  EXPECT_EQ(cut.profile_direct_flux.size(), plain.profile_direct_flux.size());
  EXPECT_EQ(cut.absorbed_power.size(), plain.absorbed_power.size());
  EXPECT_EQ(cut.radiance_field->voxel, plain.radiance_field->voxel);
  EXPECT_EQ(cut.radiance_field->radiance.size(), plain.radiance_field->radiance.size());
  // Energy: absorption summed over cells is that of the ledger, with means of the parts, too.
  for (const Solution* solution : {&plain, &cut}) {
    double absorbed = 0;
    for (const float power : solution->absorbed_power) absorbed += power / 6.;
    EXPECT_NEAR(absorbed / .6, solution->ledger.absorptance, 1e-5);
  }
  // The direct beam does not depend on cells.
  for (std::size_t e = 0; e < plain.profile_direct_flux.size(); ++e)
    EXPECT_NEAR(cut.profile_direct_flux[e], plain.profile_direct_flux[e], 1e-6);
  ASSERT_EQ(cut.direct_flux.size(), plain.direct_flux.size());
  for (std::size_t n = 0; n < plain.direct_flux.size(); ++n)
    EXPECT_NEAR(cut.direct_flux[n], plain.direct_flux[n], 1e-6F) << "each plane is that of its level";
  options.flux_levels = FluxLevels::listed;
  options.listed_levels = {1, 3};
  EXPECT_EQ(solve(problem, options).flux_level, (std::vector<int>{1, 3}));
}

TEST(ThickLevels, CutCellsComeNearThinOnes) {
  const Problem problem = thick_top(20, .2);
  SolverOptions options = coarse_options();
  options.flux_levels = FluxLevels::boundaries;
  SubdividedLevels thin;  // 64 parts of the thick level
  for (int k = 0; k < 3; ++k) {
    thin.z_edge_m.push_back(k);
    thin.level.push_back(k);
  }
  for (int part = 0; part < 64; ++part) {
    thin.z_edge_m.push_back(3 + part / 64.);
    thin.level.push_back(3);
  }
  thin.z_edge_m.push_back(4);
  const double truth =
      solve(with_subdivided_levels(problem, thin), with_subdivided_levels(options, thin)).ledger.reflectance;
  const double whole = solve(problem, options).ledger.reflectance;
  options.max_level_optical_depth = 1;
  const double cut = solve(problem, options).ledger.reflectance;
  EXPECT_GT(std::abs(whole - truth), .02 * truth);
  EXPECT_LT(std::abs(cut - truth), .1 * std::abs(whole - truth));
}

}  // namespace
}  // namespace cloudbow
