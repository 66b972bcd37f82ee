// Count of coarse solves. Truth: the number of solves.
#include <gtest/gtest.h>

#include "app/planning/coarse_solves.hpp"
#include "app/scene/accuracy.hpp"
#include "cloudbow/transport/solver.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

SolvePlan coarse_plan(const SolvePlan& plan, SolvedAs as) {
  return plan.with(coarse_options(plan.whole_options(), "balanced", as));
}

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
  const SolverOptions other = coarse_options(options, "balanced", SolvedAs::field);
  EXPECT_LT(other.column_streams, options.column_streams);
  EXPECT_EQ(coarse_seconds_of(SolvePlan(problem, options)), predict_seconds(SolvePlan(problem, other)));
}

TEST(CoarseSolves, OfOneColumnByItsStreamsHaveOtherStreams) {
  const auto coarse_streams = [](int streams) {
    SolverOptions options = accuracy_options("balanced", HorizontalExtent::column, false);
    options.independent_columns = true;
    options.column_streams = streams;
    return coarse_options(options, "balanced", SolvedAs::column_by_its_streams).column_streams;
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
  const SolverOptions other = coarse_options(options, "balanced", SolvedAs::field);
  ASSERT_TRUE(coarse_solves.probe);
  EXPECT_EQ(coarse_solves.probe->by_ordinates.box.columns(), 8U);
  const double seconds = coarse_seconds_of(SolvePlan(problem, options));
  EXPECT_GT(seconds, predict_seconds(SolvePlan(problem, other))) << "the constant source takes fewer sweeps";
  EXPECT_LT(seconds, 2 * predict_seconds(SolvePlan(problem, other)) + predict_seconds(SolvePlan(problem, options)))
      << "of 8 columns of 12";
}

}  // namespace
}  // namespace cloudbow
