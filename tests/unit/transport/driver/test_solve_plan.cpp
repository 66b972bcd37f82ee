// Properties of a problem in a plan. Truth: the problem as it was made.
#include <gtest/gtest.h>

#include <vector>

#include "cloudbow/transport/solver.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

// Varies along x alone; its upper level is thick.
Problem rolls() {
  const BoxGrid box = make_box(3, 4, 2);
  std::vector<float> extinction(24);
  for (std::size_t c = 0; c < 24; ++c) extinction[c] = (c < 12 ? .1F : 10.F) * static_cast<float>(1 + c % 3);
  Problem problem;
  problem.grid = make_grid(box, extinction, .99);
  problem.phase = {PhaseFunction::henyey_greenstein(.7)};
  problem.sun = Sun{travel_along(-.6, 20), 1.};
  return problem;
}

SolverOptions reduced() {
  SolverOptions options = coarse_options();
  options.collapse_uniform_axes = true;
  options.max_level_optical_depth = 2;
  return options;
}

TEST(SolvePlan, AsGivenIfNothingIsAskedFor) {
  const Problem problem = rolls();
  const SolvePlan plan(problem, coarse_options());
  EXPECT_EQ(&plan.problem(), &problem);
  EXPECT_FALSE(plan.collapsed_axes().any());
  EXPECT_EQ(plan.added_levels(), 0);
  EXPECT_EQ(plan.cells(), 24U);
  EXPECT_FALSE(plan.in_double());
}

TEST(SolvePlan, CollapsesAndSubdivides) {
  const Problem problem = rolls();
  const SolvePlan plan(problem, reduced());
  EXPECT_FALSE(plan.collapsed_axes().x);
  EXPECT_TRUE(plan.collapsed_axes().y);
  EXPECT_EQ(plan.collapsed().grid.box.ny, 1);
  EXPECT_GT(plan.added_levels(), 0);
  EXPECT_EQ(plan.problem().grid.box.nz(), 2 + plan.added_levels());
  EXPECT_EQ(plan.cells(), 3U * static_cast<std::size_t>(plan.problem().grid.box.nz()));
  EXPECT_FALSE(plan.is_one_column());
}

TEST(SolvePlan, OfAnotherWayKeepsWhatTheyHaveInCommon) {
  const Problem problem = rolls();
  const SolvePlan plan(problem, reduced());
  SolverOptions other = reduced();
  other.tolerance = 1e-2;
  EXPECT_EQ(&plan.with(other).problem(), &plan.problem());
  other.fit.delta_m_order = 2;  // the beam fades elsewhere
  const SolvePlan otherwise = plan.with(other);
  EXPECT_EQ(&otherwise.collapsed(), &plan.collapsed());
  EXPECT_NE(&otherwise.problem(), &plan.problem());
  other.collapse_uniform_axes = false;
  EXPECT_EQ(&plan.with(other).collapsed(), &problem);
}

// Truth: the same plan made from nothing.
TEST(SolvePlan, OfAnotherWayIsThatFromNothing) {
  const Problem problem = rolls();
  for (const bool collapse : {false, true}) {
    for (const double depth : {0., 2.}) {
      SolverOptions other = coarse_options();
      other.collapse_uniform_axes = collapse;
      other.max_level_optical_depth = depth;
      other.flux_levels = FluxLevels::listed;
      other.listed_levels = {0, 1, 2};
      const SolvePlan derived = SolvePlan(problem, reduced()).with(other), made(problem, other);
      EXPECT_EQ(derived.levels().z_edge_m, made.levels().z_edge_m);
      EXPECT_EQ(derived.problem().grid.absorption, made.problem().grid.absorption);
      EXPECT_EQ(derived.options().listed_levels, made.options().listed_levels);
      EXPECT_EQ(derived.in_double(), made.in_double());
      EXPECT_EQ(predict_memory(derived), predict_memory(made));
    }
  }
}

TEST(SolvePlan, OneColumnIsSolvedInDouble) {
  Problem problem = rolls();
  problem.grid = make_grid(make_box(3, 4, 2), std::vector<float>(24, .5F), .99);
  const SolvePlan plan(problem, reduced());
  EXPECT_TRUE(plan.is_one_column());
  EXPECT_TRUE(plan.in_double());
  EXPECT_EQ(plan.threads(), 1);
}

TEST(SolvePlan, PolarStreamsNeedColumnsWithoutRadiances) {
  const Problem problem = rolls();
  SolverOptions options = coarse_options();
  EXPECT_FALSE(SolvePlan(problem, options).by_polar_streams());
  options.independent_columns = true;
  EXPECT_TRUE(SolvePlan(problem, options).by_polar_streams());
  options.radiance_field = true;
  EXPECT_FALSE(SolvePlan(problem, options).by_polar_streams());
}

}  // namespace
}  // namespace cloudbow
