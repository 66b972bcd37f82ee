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

// Of the radiance at 48 ordinates, 68 numbers of moments and their mixing, and 48 of slopes, four ranks keep a quarter
// each. Their messages take 25 MB.
TEST(SolveLimits, RanksDivideTheMemoryOfCells) {
  constexpr double messages = 25e6;
  const BoxGrid box = make_box(60, 60, 10);
  Problem problem = cloudy();
  problem.grid = make_grid(box, random_extinction(box, 2., 1, true), .99);
  SolverOptions options = quick();
  options.threads = 1;
  options.flux_levels = FluxLevels::boundaries;
  const SolvePlan plan(problem, options);
  const auto of_ranks = [&plan](int ranks) { return static_cast<double>(predict_memory(plan, ranks)); };
  const double divided = 36'000. * (48 + 68 + 48) * sizeof(float);
  EXPECT_NEAR(of_ranks(1) + messages - of_ranks(4), .75 * divided, 1);
  EXPECT_LT(of_ranks(8), of_ranks(4));
  options.independent_columns = options.radiance_field = true;  // one rank solves these
  const SolvePlan columns(problem, options);
  EXPECT_EQ(static_cast<double>(predict_memory(columns, 4)), static_cast<double>(predict_memory(columns)) + messages);
}

}  // namespace
}  // namespace cloudbow
