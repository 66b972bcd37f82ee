// Light of a solve in the cells of another. Truth: means over parts, and light that is linear in height.
#include <gtest/gtest.h>

#include "solve_test_tools.hpp"
#include "transport/driver/carried_light.hpp"
#include "transport/grid/cells.hpp"

namespace cloudbow {
namespace {

Problem thick_problem() {
  const BoxGrid box = make_box(4, 3, 3);
  std::vector<float> extinction = random_extinction(box, 6, 2);
  extinction[5] = 0;
  return problem_of(make_grid(box, extinction, .99), PhaseFunction::henyey_greenstein(.85));
}

SolvePlan plan_of(const Problem& problem, double level_depth, double column_depth) {
  SolverOptions options = coarse();
  options.max_level_optical_depth = level_depth;
  options.max_column_optical_depth = column_depth;
  return SolvePlan(problem, options);
}

/// As if from a solve: one moment, whose value is `value(z)` at the middle of each cell, and its relative slopes.
template <class Value>
CellLight light_by_height(const SolvePlan& plan, const Value& value) {
  const OpticalGrid& grid = plan.problem().grid;
  const std::size_t n = grid.active_cells();
  CellLight light{plan, std::vector<float>(n),
                  std::vector<std::vector<float>>(3, std::vector<float>(n + lane_padding))};
  const std::vector<double>& z = grid.box.z_edge_m;
  grid.for_each_place([&](int k, std::size_t, std::size_t c) {
    light.moments[c] = static_cast<float>(value(.5 * (z[k] + z[k + 1])));
    light.slopes[2][c] = static_cast<float>((z[k + 1] - z[k]) * .1);  // a gradient of .1 per metre
    light.slopes[0][c] = static_cast<float>(grid.box.dx_m * .2);
  });
  return light;
}

TEST(CarriedLight, IsTheMeanOfTheParts) {
  const Problem problem = thick_problem();
  const SolvePlan parts = plan_of(problem, 2, .2), whole = parts.with(plan_of(problem, 0, 0).whole_options());
  ASSERT_TRUE(parts.column_parts().any());
  ASSERT_GT(parts.added_levels(), 0);
  ASSERT_EQ(&whole.problem(), &problem);
  CellLight light = light_by_height(parts, [](double z) { return 3 + z; });
  ASSERT_TRUE(can_carry(light, whole));
  const CellLight there = carried_light(std::move(light), whole);
  ASSERT_EQ(there.moments.size(), problem.grid.active_cells());
  const std::vector<double>& z = problem.grid.box.z_edge_m;
  problem.grid.for_each_place([&](int k, std::size_t, std::size_t c) {
    EXPECT_NEAR(there.moments[c], 3 + .5 * (z[k] + z[k + 1]), 1e-5);
    EXPECT_NEAR(there.slopes[2][c], .1 * (z[k + 1] - z[k]), 1e-6);
    EXPECT_NEAR(there.slopes[0][c], .2 * problem.grid.box.dx_m, 1e-6);
    EXPECT_EQ(there.slopes[1][c], 0);
  });
}

TEST(CarriedLight, IntoPartsIsThatOfTheWhole) {
  const Problem problem = thick_problem();
  const SolvePlan whole = plan_of(problem, 0, 0), parts = whole.with(plan_of(problem, 2, .2).whole_options());
  const CellLight there = carried_light(light_by_height(whole, [](double z) { return 3 + z; }), parts);
  const OpticalGrid& grid = parts.problem().grid;
  ASSERT_EQ(there.moments.size(), grid.active_cells());
  const std::vector<double>& z = problem.grid.box.z_edge_m;
  grid.for_each_place([&](int k, std::size_t, std::size_t c) {
    const auto level = static_cast<std::size_t>(parts.levels().level[static_cast<std::size_t>(k)]);
    EXPECT_NEAR(there.moments[c], 3 + .5 * (z[level] + z[level + 1]), 1e-5);
    EXPECT_NEAR(there.slopes[2][c], .1 * grid.box.thickness_m(k), 1e-6);
    EXPECT_NEAR(there.slopes[0][c], .2 * grid.box.dx_m, 1e-6);
  });
}

TEST(CarriedLight, OfAnotherProblemIsNotUsed) {
  const Problem problem = thick_problem(), other = thick_problem();
  const SolvePlan plan = plan_of(problem, 0, 0);
  CellLight light;
  EXPECT_FALSE(can_carry(light, plan));
  const Solution truth = solve(plan, {}, {.light = &light});
  EXPECT_TRUE(can_carry(light, plan));
  EXPECT_FALSE(can_carry(light, plan_of(other, 0, 0)));
  EXPECT_EQ(solve(plan_of(other, 0, 0), {}, {.light = &light}).upwelling_flux, truth.upwelling_flux);
}

TEST(CarriedLight, SavesSweepsAndLeavesTheAnswer) {
  const Problem problem = thick_problem();
  const SolvePlan plan = plan_of(problem, 2, 2), whole = plan.with(plan_of(problem, 0, 0).whole_options());
  CellLight light;
  solve(plan, {}, {.light = &light});
  const Solution truth = solve(whole), started = solve(whole, {}, {.light = &light});
  EXPECT_LT(started.report.sweeps, truth.report.sweeps);
  EXPECT_NEAR(started.ledger.reflectance, truth.ledger.reflectance, 5e-3) << "slopes are those of the other cells";
  EXPECT_EQ(&light.plan->problem(), &problem);
}

// Other ranks have no light of it.
TEST(CarriedLight, IsNotLeftByColumns) {
  const Problem problem = thick_problem();
  SolverOptions columns = coarse();
  columns.independent_columns = columns.radiance_field = true;
  CellLight light;
  solve(SolvePlan(problem, columns), {}, {.light = &light});
  EXPECT_FALSE(light.plan);
}

}  // namespace
}  // namespace cloudbow
