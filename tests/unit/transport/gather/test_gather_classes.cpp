#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "transport/gather/gather_classes.hpp"

namespace cloudbow {
namespace {

TEST(GatherClasses, AreRangesOfDirectionsOfSimilarSpread) {
  std::vector<GatherDirection> directions = gather_directions(200, true, std::nullopt);
  double before = 0;
  for (const GatherDirection& direction : directions) before += power(direction);
  const std::vector<SpreadClass> classes = spread_classes(directions);
  ASSERT_FALSE(classes.empty());
  std::size_t next = 0;
  double powers = 0, last_spread = 0;
  for (const SpreadClass& alike : classes) {
    EXPECT_EQ(alike.first, next);
    EXPECT_LT(alike.first, alike.last);
    EXPECT_GT(alike.spread, last_spread);
    next = alike.last;
    last_spread = alike.spread;
    for (std::size_t q = alike.first; q < alike.last; ++q) powers += power(directions[q]);
  }
  EXPECT_EQ(next, directions.size());
  EXPECT_NEAR(powers, before, 1e-12);
  EXPECT_NEAR(powers, std::numbers::pi, 1e-12);  // of an isotropic radiance 1
}

// Even over a column: the mean of a linear function is that of the middle, with the discrepancy of so many points.
TEST(GatherClasses, RaysStartAllOverTheirColumns) {
  constexpr std::size_t count = 512;
  double x = 0, y = 0;
  for (std::size_t q = 0; q < count; ++q) {
    const LaunchPlace place = launch_place(q, true);
    ASSERT_TRUE(place.x >= 0 && place.x < 1 && place.y >= 0 && place.y < 1);
    x += place.x / count;
    y += place.y / count;
    EXPECT_EQ(launch_place(q, false).x, .5);
  }
  EXPECT_NEAR(x, .5, .01);
  EXPECT_NEAR(y, .5, .01);
}

}  // namespace
}  // namespace cloudbow
