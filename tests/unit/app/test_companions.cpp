// What companions are counted as. Truth: how many solves there are.
#include <gtest/gtest.h>

#include "cloudbow/app/accuracy.hpp"
#include "companions.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

Problem small_field() {
  const BoxGrid box = make_box(4, 3, 5);
  Problem problem;
  problem.grid = make_grid(box, random_extinction(box, 2, 5), .99);
  problem.phase = {PhaseFunction::henyey_greenstein(.8)};
  problem.sun = Sun{travel_along(-.6, 20), 1.};
  return problem;
}

TEST(Companions, OfColumnsAreOneSolve) {
  const Problem problem = small_field();
  SolverOptions options = accuracy_options("balanced", false, false);
  options.independent_columns = true;
  const Companions companions = solve_companions(problem, options, "balanced", SolvedAs::field, {});
  EXPECT_EQ(companions.constant.upwelling_flux, companions.linear.upwelling_flux);
  EXPECT_EQ(companions.linear.report.sweeps + companions.constant.report.sweeps, 1);
  EXPECT_EQ(companions.constant.report.cpu_seconds, 0);
  const SolverOptions other = companion_options(options, "balanced", SolvedAs::field);
  EXPECT_LT(other.column_streams, options.column_streams);
  EXPECT_EQ(predict_companion_seconds(problem, options, "balanced", SolvedAs::field), predict_seconds(problem, other));
}

TEST(Companions, OfOneColumnByItsStreamsHaveMoreStreams) {
  SolverOptions options = accuracy_options("balanced", true, false);
  options.independent_columns = true;
  EXPECT_EQ(companion_options(options, "balanced", SolvedAs::column_by_its_streams).column_streams,
            2 * options.column_streams);
}

TEST(Companions, OfFieldsAreTwo) {
  const Problem problem = small_field();
  const SolverOptions options = accuracy_options("balanced", false, false);
  const Companions companions = solve_companions(problem, options, "balanced", SolvedAs::field, {});
  EXPECT_NE(companions.constant.upwelling_flux, companions.linear.upwelling_flux);
  EXPECT_GE(companions.constant.report.sweeps, 1);
  const SolverOptions other = companion_options(options, "balanced", SolvedAs::field);
  EXPECT_EQ(predict_companion_seconds(problem, options, "balanced", SolvedAs::field),
            2 * predict_seconds(problem, other));
}

}  // namespace
}  // namespace cloudbow
