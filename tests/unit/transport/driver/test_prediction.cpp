// Memory and time of a solve, predicted. Truth: the work that is counted by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "cloudbow/core/error.hpp"
#include "cloudbow/transport/solver.hpp"
#include "limit_test_tools.hpp"
#include "transport/driver/path_load.hpp"
#include "transport/problem/finite.hpp"
#include "transport/rays/path_pattern.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

TEST(SolveLimits, MemoryOfLongPatternsIsForeseen) {
  const double zenith = std::atan(1e6) * 180 / std::numbers::pi;  // 3e6 segments of 72 bytes
  SolverOptions options = quick();
  options.threads = 1;
  EXPECT_GT(predicted_memory(under_zenith(zenith), options), predicted_memory(under_zenith(60), options) + 200'000'000);
  EXPECT_GT(predicted_seconds(under_zenith(zenith), options), predicted_seconds(under_zenith(60), options) + 1);
}

TEST(SolveLimits, FewCellsAreForeseenOnTheOneThreadThatSolvesThem) {
  SolverOptions one = quick(), many = quick();
  one.threads = 1;
  many.threads = 64;
  EXPECT_EQ(predicted_memory(under_zenith(89.99), many), predicted_memory(under_zenith(89.99), one));
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

TEST(SolveLimits, TablesOfReflectionAreForeseen) {
  Problem sea = cloudy();
  sea.surface.brdf = SurfaceBrdf::cox_munk(7, 1.34);
  // 1313 x 1313 samples, in double precision, and their products with 642 points.
  EXPECT_GT(predicted_memory(sea, quick()), predicted_memory(cloudy(), quick()) + 20'000'000);
}

}  // namespace
}  // namespace cloudbow
