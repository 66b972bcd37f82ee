// Time of a solve, predicted. Truth: the work that is counted by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "cloudbow/transport/solve_seconds.hpp"
#include "cloudbow/transport/solver.hpp"
#include "limit_test_tools.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

TEST(SolveLimits, LongPatternsAreForeseen) {
  const double zenith = std::atan(1e6) * 180 / std::numbers::pi;  // 3e6 segments
  SolverOptions options = quick();
  options.threads = 1;
  EXPECT_GT(predicted_seconds(under_zenith(zenith), options), predicted_seconds(under_zenith(60), options) + 1);
}

TEST(SolveLimits, FewCellsAreForeseenOnTheOneThreadThatSolvesThem) {
  SolverOptions one = quick(), many = quick();
  one.threads = 1;
  many.threads = 64;
  EXPECT_EQ(predicted_seconds(under_zenith(89.99), many), predicted_seconds(under_zenith(89.99), one));
}

TEST(SolveLimits, LinesOfSightAreForeseenByTheCellsThatTheyCross) {
  const auto seconds = [](const Eigen::Vector3d& look_at) {
    Problem thin = cloudy();
    for (float& a : thin.grid.absorption) a *= 1e-4F;
    for (float& s : thin.grid.scattering.front()) s *= 1e-4F;
    SolverOptions options = quick();
    options.cameras = {
        make_camera("c", Camera::Projection::perspective, {{2, 1.5, .01}, look_at, {0, 1, 0}}, .02, 3000, 3000, 1)};
    return predicted_seconds(thin, options);
  };
  // 3 cells straight up; at a slope of a hundredth 300 cells for each of the three levels.
  EXPECT_GT(seconds({2, 1.5, 100}), predicted_seconds(cloudy(), quick()) + 1);
  EXPECT_GT(seconds({102, 1.5, 5}), 3 * seconds({2, 1.5, 100}));
}

// Lanes of the processor hold half as many numbers.
TEST(SolveLimits, SweepsInDoubleTakeMoreThanTwiceTheTime) {
  const Problem problem = cloudy();
  SolverOptions options = quick();
  const double in_float = predict_phases(SolvePlan(problem, options)).sweep;
  options.double_precision = true;
  EXPECT_GT(predict_phases(SolvePlan(problem, options)).sweep, 2 * in_float);
}

// The factor is .3 for each tenfold of columns beyond 3e4, 1.34 in all. The rest of the work per column is the same.
TEST(SolveLimits, WidePlanesTakeMoreTimePerVoxel) {
  const auto seconds_per_column = [](int width) {
    Problem problem = cloudy();
    const BoxGrid box = make_box(width, width, 1);
    std::vector<float> extinction(box.columns());
    for (std::size_t c = 0; c < extinction.size(); ++c) extinction[c] = c % 16 < 8 ? .5F : .6F;
    problem.grid = make_grid(box, extinction, .99);
    return predict_phases(SolvePlan(problem, quick())).sweep / static_cast<double>(box.columns());
  };
  EXPECT_NEAR(seconds_per_column(640) / seconds_per_column(160), 1.34, .01);
}

TEST(SolveLimits, FinerTolerancesTakeMoreSweeps) {
  const Problem problem = cloudy();
  SolverOptions options = quick();
  options.tolerance = 1e-3;
  const double coarse = predict_phases(SolvePlan(problem, options)).sweeps;
  options.tolerance = 1e-5;
  EXPECT_GT(predict_phases(SolvePlan(problem, options)).sweeps, coarse + 2);
}

// They have their fluxes from the iteration.
TEST(SolveLimits, IndependentColumnsHaveNoFinalGather) {
  const Problem problem = cloudy();
  SolverOptions options = quick();
  options.radiance_field = true;  // by ordinates
  const double gather = predict_phases(SolvePlan(problem, options)).after_sweeps;
  options.independent_columns = true;
  EXPECT_LT(predict_phases(SolvePlan(problem, options)).after_sweeps, .5 * gather);
}

TEST(SolveLimits, ColumnsWithoutIterationHaveNoSweeps) {
  const Problem problem = cloudy();
  SolverOptions options = quick();
  options.independent_columns = true;
  const SolvePlan plan(problem, options);
  EXPECT_EQ(predict_phases(plan).total(), predict_phases(plan).before_sweeps);
  EXPECT_GT(predict_seconds(plan), 0);
}

}  // namespace
}  // namespace cloudbow
