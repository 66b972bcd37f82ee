// Paths of ordinates through a box. Truth: light near the horizon has fewer segments sideways, and each path crosses
// all levels.
#include <gtest/gtest.h>

#include <vector>

#include "transport/rays/ordinate_path.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

class OrdinatePathTest : public testing::Test {
 protected:
  OrdinatePath path_along(const Direction& travel, bool independent_columns = false) const {
    return make_ordinate_paths<double>(box_, cells_, {travel}, independent_columns).front();
  }
  static int levels_of(const OrdinatePath& path) {
    int levels = 0;
    for (const PathPattern& pattern : path.along_z) levels += pattern.levels();
    for (const SidewaysPath& run : path.sideways) levels += run.levels.last - run.levels.first;
    return levels;
  }

  const BoxGrid box_ = make_box(16, 12, 8);
  const std::vector<double> untruncated_{0.};
  const Cells<double> cells_ =
      make_cells<double>(make_grid(box_, random_extinction(box_, .1, 9), 1.), untruncated_, false, 1);
};

TEST_F(OrdinatePathTest, SteepOrdinatesMarchAlongZAlone) {
  for (const double mu : {.95, -.95}) {
    const OrdinatePath path = path_along(travel_along(mu, 40));
    EXPECT_EQ(path.upward, mu > 0);
    EXPECT_TRUE(path.sideways.empty());
    ASSERT_EQ(path.along_z.size(), 1U);
    EXPECT_EQ(levels_of(path), 8);
    EXPECT_GT(path.cost, 0);
  }
}

TEST_F(OrdinatePathTest, GrazingOrdinatesMarchSidewaysWhereTheyMay) {
  const OrdinatePath path = path_along(travel_along(.1, 8));
  ASSERT_EQ(path.sideways.size(), 1U);
  EXPECT_EQ(path.sideways[0].axis, 0) << "8 degrees from x";
  EXPECT_EQ(path.along_z.size(), 2U);
  EXPECT_EQ(levels_of(path), 8);
  EXPECT_EQ(path_along(travel_along(.1, 80)).sideways.at(0).axis, 1);
}

// Levels of 1 m, one of .3 m, levels of .5 m, one of .7 m and levels of 1 m again.
TEST_F(OrdinatePathTest, EachRunOfEvenLevelsIsMarchedSideways) {
  BoxGrid box = make_box(16, 12, 13);
  box.z_edge_m = {0, 1, 2, 3, 3.3, 3.8, 4.3, 4.8, 5.3, 6, 7, 8, 9, 10};
  const auto cells = make_cells<double>(make_grid(box, random_extinction(box, .1, 9), 1.), untruncated_, false, 1);
  ASSERT_EQ(cells.even_runs.size(), 3U);
  for (const double mu : {.1, -.1}) {
    const OrdinatePath path = make_ordinate_paths<double>(box, cells, {travel_along(mu, 8)}, false).front();
    EXPECT_EQ(levels_of(path), 13);
    ASSERT_EQ(path.sideways.size(), 3U);
    ASSERT_EQ(path.along_z.size(), 4U);
    const std::size_t first = mu > 0 ? 0 : 2, last = 2 - first;  // from below
    EXPECT_EQ(path.sideways[first].levels.first, 0);
    EXPECT_EQ(path.sideways[1].levels.first, 4);
    EXPECT_EQ(path.sideways[last].levels.last, 13);
    EXPECT_EQ(path.along_z[1 + first / 2].first_level, 3);
    EXPECT_EQ(path.along_z.front().levels(), 0);
    EXPECT_EQ(path.along_z.back().levels(), 0);
    EXPECT_EQ(path.sideways[0].pattern, path.sideways[2].pattern) << "levels of one thickness";
    EXPECT_NE(path.sideways[0].pattern, path.sideways[1].pattern);
  }
}

// One ray per cell does not sample what varies within it. Along z, several rays cross each cell.
TEST_F(OrdinatePathTest, ThickVoxelsAreMarchedAlongZAlone) {
  const auto path_in = [&](float depth) {
    std::vector<float> extinction = random_extinction(box_, .1, 9);  // levels are 1 m thick
    for (float& e : extinction) e = e > 0 ? depth : 0;
    const auto cells = make_cells<double>(make_grid(box_, extinction, 1.), untruncated_, false, 1);
    return make_ordinate_paths<double>(box_, cells, {travel_along(.1, 8)}, false).front();
  };
  EXPECT_FALSE(path_in(1.3F).sideways.empty());
  EXPECT_TRUE(path_in(1.4F).sideways.empty());
}

TEST_F(OrdinatePathTest, CostGrowsTowardsTheHorizonUntilTheyTurnSideways) {
  EXPECT_LT(path_along(travel_along(.9, 30)).cost, path_along(travel_along(.5, 30)).cost);
}

}  // namespace
}  // namespace cloudbow
