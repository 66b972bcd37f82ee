// Count of coarse solves. Truth: the number of solves.
#include <gtest/gtest.h>

#include "app/planning/coarse_solves.hpp"
#include "app/scene/accuracy.hpp"
#include "cloudbow/transport/solver.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

SolvePlan coarse_plan(const SolvePlan& plan, SolvedAs as) { return coarse_plan(plan, "balanced", as); }

CoarseSolves coarse_solves_of(const SolvePlan& plan, SolvedAs as) {
  return solve_coarsely(plan, coarse_plan(plan, as), as, {});
}

double coarse_seconds_of(const SolvePlan& plan) {
  return predict_coarse_seconds(plan, coarse_plan(plan, SolvedAs::field), SolvedAs::field);
}

Problem small_field() {
  const BoxGrid box = make_box(4, 3, 5);
  Problem problem;
  problem.grid = make_grid(box, random_extinction(box, 2, 5), .99);
  problem.phase = {PhaseFunction::henyey_greenstein(.8)};
  problem.sun = Sun{travel_along(-.6, 20), 1.};
  return problem;
}

TEST(CoarseSolves, OfColumnsAreOneSolve) {
  const Problem problem = small_field();
  SolverOptions options = accuracy_options("balanced", HorizontalExtent::field, false);
  options.independent_columns = true;
  const CoarseSolves coarse_solves = coarse_solves_of(SolvePlan(problem, options), SolvedAs::field);
  EXPECT_EQ(coarse_solves.constant.upwelling_flux, coarse_solves.linear.upwelling_flux);
  EXPECT_EQ(coarse_solves.linear.report.sweeps + coarse_solves.constant.report.sweeps, 1);
  EXPECT_EQ(coarse_solves.constant.report.cpu_seconds, 0);
  EXPECT_FALSE(coarse_solves.probe);
  const SolvePlan plan(problem, options), other = coarse_plan(plan, SolvedAs::field);
  EXPECT_LT(other.options().column_streams, options.column_streams);
  EXPECT_EQ(coarse_seconds_of(plan), predict_seconds(other));
}

TEST(CoarseSolves, OfOneColumnByItsStreamsHaveOtherStreams) {
  const Problem problem = small_field();
  const auto coarse_streams = [&problem](int streams) {
    SolverOptions options = accuracy_options("balanced", HorizontalExtent::column, false);
    options.independent_columns = true;
    options.column_streams = streams;
    return coarse_plan(SolvePlan(problem, options), SolvedAs::column_by_its_streams).options().column_streams;
  };
  EXPECT_EQ(coarse_streams(4), 8);
  EXPECT_EQ(coarse_streams(12), 16);
  EXPECT_EQ(coarse_streams(14), 16);
  EXPECT_EQ(coarse_streams(16), 12);
}

// By ordinates, as voxels and images are, and as it is.
TEST(CoarseSolves, OfOneColumnBesideStreamsAreItsStreams) {
  Problem problem;
  problem.grid = make_grid(make_box(1, 1, 5), {40, 40, 40, 40, 40}, .99);
  problem.phase = {PhaseFunction::henyey_greenstein(.8)};
  problem.sun = Sun{travel_along(-.6, 20), 1.};
  SolverOptions options = coarse_options();
  EXPECT_EQ(solved_as(SolvePlan(problem, options), true), SolvedAs::column_beside_streams);
  const CoarseSolves coarse_solves = coarse_solves_of(SolvePlan(problem, options), SolvedAs::column_beside_streams);
  options.independent_columns = true;
  options.column_streams = 16;
  EXPECT_NEAR(coarse_solves.linear.ledger.reflectance, solve(problem, options).ledger.reflectance, 1e-12);
  problem.surface.brdf.emplace();
  options.independent_columns = false;
  EXPECT_EQ(solved_as(SolvePlan(problem, options), true), SolvedAs::column) << "streams know no azimuths";
}

TEST(CoarseSolves, OfAFieldThatDoesNotVaryAreThoseOfAColumn) {
  Problem problem = small_field();
  SolverOptions options = coarse_options();
  options.collapse_uniform_axes = true;
  EXPECT_EQ(solved_as(SolvePlan(problem, options), false), SolvedAs::field);
  const BoxGrid box = make_box(4, 3, 5);
  problem.grid = make_grid(box, std::vector<float>(60, .5F), .99);
  EXPECT_EQ(solved_as(SolvePlan(problem, options), false), SolvedAs::column_beside_streams);
  options.collapse_uniform_axes = false;
  EXPECT_EQ(solved_as(SolvePlan(problem, options), false), SolvedAs::field);
}

// Truth: thick cells forget how high the sun stands, and a slab of them has an exact solution.
TEST(CoarseSolves, TellWhatThickCellsCost) {
  for (const double ssa : {.99, 1.}) {
    Problem problem;
    problem.grid = make_grid(make_box(2, 2, 4), std::vector<float>(16, 50.F), ssa);
    problem.phase = {PhaseFunction::henyey_greenstein(.5)};
    problem.sun = Sun{travel_along(-.05, 20), 1.};
    const SolverOptions options = coarse_options();
    const Solution solution = solve(problem, options);
    SolverOptions exact = options;
    exact.independent_columns = true;
    exact.column_streams = 16;
    const Solution truth = solve(problem, exact);
    const double error = flux_distance(solution, truth).domain;
    ASSERT_GT(error, .01);
    const CoarseSolves coarse_solves = coarse_solves_of(SolvePlan(problem, options), SolvedAs::field);
    const ErrorEstimate estimate =
        estimate_error(solution, coarse_solves, error_weights("balanced", SolvedAs::field), false);
    // The same columns by the same ordinates, but for their iteration.
    EXPECT_GT(estimate.domain.total(), .98 * error) << ssa;
    EXPECT_NEAR(estimate.probe_distance.domain, error, .02 * error) << ssa;
  }
}

TEST(CoarseSolves, OfFieldsAreTwoAndAProbe) {
  const Problem problem = small_field();
  const SolverOptions options = accuracy_options("balanced", HorizontalExtent::field, false);
  const CoarseSolves coarse_solves = coarse_solves_of(SolvePlan(problem, options), SolvedAs::field);
  EXPECT_NE(coarse_solves.constant.upwelling_flux, coarse_solves.linear.upwelling_flux);
  EXPECT_GE(coarse_solves.constant.report.sweeps, 1);
  const SolvePlan other = coarse_plan(SolvePlan(problem, options), SolvedAs::field);
  ASSERT_TRUE(coarse_solves.probe);
  EXPECT_EQ(coarse_solves.probe->by_ordinates.box.columns(), 8U);
  const double seconds = coarse_seconds_of(SolvePlan(problem, options));
  EXPECT_GT(seconds, predict_seconds(other)) << "two solves of fewer sweeps, and the probe";
  EXPECT_LT(seconds, 2 * predict_seconds(other) + predict_seconds(SolvePlan(problem, options))) << "of 8 columns of 12";
}

// Truth: the same without the light of the solution.
TEST(CoarseSolves, StartFromTheLightOfTheSolution) {
  const Problem problem = small_field();
  const SolvePlan plan(problem, accuracy_options("balanced", HorizontalExtent::field, false));
  CellLight light;
  const Solution solution = solve(plan, {}, {.light = &light});
  const CoarseSolves alone = coarse_solves_of(plan, SolvedAs::field);
  const SolvePlan coarse = coarse_plan(plan, SolvedAs::field);
  const CoarseSolves started = solve_coarsely(plan, coarse, SolvedAs::field, {}, std::move(light));
  EXPECT_LT(started.linear.report.sweeps + 2, alone.linear.report.sweeps);
  EXPECT_LE(started.constant.report.sweeps, alone.constant.report.sweeps);
  const ByFlux angular = flux_distance(solution, started.linear), before = flux_distance(solution, alone.linear);
  EXPECT_NEAR(angular.up, before.up, .1 * before.up);
  EXPECT_NEAR(angular.down, before.down, .1 * before.down);
}

TEST(CoarseSolves, HaveFluxesAtSomeLevelsBetween) {
  const BoxGrid box = make_box(4, 3, 30);
  std::vector<float> extinction = random_extinction(box, 1, 5);
  std::fill(extinction.begin(), extinction.begin() + 12 * 5, 0.F);  // five levels without cloud below
  Problem problem = small_field();
  problem.grid = make_grid(box, extinction, .99);
  const SolvePlan plan(problem, accuracy_options("draft", HorizontalExtent::field, false));
  const CoarseSolves coarse_solves = coarse_solves_of(plan, SolvedAs::field);
  const std::vector<int>& linear = coarse_solves.linear.flux_level;
  EXPECT_EQ(linear.size(), 18U);
  EXPECT_EQ(coarse_solves.constant.flux_level.size(), 8U);
  for (const int level : coarse_solves.constant.flux_level)
    EXPECT_NE(std::find(linear.begin(), linear.end(), level), linear.end()) << level;
  EXPECT_EQ(linear.front(), 0);
  EXPECT_GE(linear[1], 5);
  EXPECT_EQ(linear.back(), 30);
}

}  // namespace
}  // namespace cloudbow
