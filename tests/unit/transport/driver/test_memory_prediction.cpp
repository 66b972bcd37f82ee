// Memory of a solve, predicted. Truth: the arrays that are counted by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "cloudbow/transport/solver.hpp"
#include "limit_test_tools.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

TEST(SolveLimits, MemoryOfLongPatternsIsForeseen) {
  const double zenith = std::atan(1e6) * 180 / std::numbers::pi;  // 3e6 segments of 72 bytes
  SolverOptions options = quick();
  options.threads = 1;
  EXPECT_GT(predicted_memory(under_zenith(zenith), options), predicted_memory(under_zenith(60), options) + 200'000'000);
}

TEST(SolveLimits, FewCellsTakeTheMemoryOfOneThread) {
  SolverOptions one = quick(), many = quick();
  one.threads = 1;
  many.threads = 64;
  EXPECT_EQ(predicted_memory(under_zenith(89.99), many), predicted_memory(under_zenith(89.99), one));
}

TEST(SolveLimits, MemoryOfTablesOfReflectionIsForeseen) {
  Problem sea = cloudy();
  sea.surface.brdf = SurfaceBrdf::cox_munk(7, 1.34);
  // 1313 x 1313 samples, in double precision, and their products with 642 points.
  EXPECT_GT(predicted_memory(sea, quick()), predicted_memory(cloudy(), quick()) + 20'000'000);
}

// 36 000 cells, each with 40 numbers more than its radiance at 48 ordinates at least.
TEST(SolveLimits, DoublePrecisionTakesTwiceTheMemoryOfItsCells) {
  const BoxGrid box = make_box(60, 60, 10);
  Problem problem = cloudy();
  problem.grid = make_grid(box, random_extinction(box, 2., 1), .99);
  SolverOptions options = quick();
  options.threads = 1;
  options.flux_levels = FluxLevels::boundaries;
  const std::size_t in_float = predicted_memory(problem, options);
  options.double_precision = true;
  EXPECT_GT(predicted_memory(problem, options), in_float + 36'000 * 88 * sizeof(float));
}

}  // namespace
}  // namespace cloudbow
