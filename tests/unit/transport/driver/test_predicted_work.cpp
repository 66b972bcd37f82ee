// Counts of the work of a solve. Truth: counted by hand.
#include <gmock/gmock.h>

#include "limit_test_tools.hpp"
#include "transport/driver/predicted_work.hpp"

namespace cloudbow {
namespace {

Camera wide_camera() {
  return make_camera("c", Camera::Projection::perspective, {{2, 1.5, .01}, {2, 1.5, 100}, {0, 1, 0}}, .02, 3000, 1500,
                     1);
}

TEST(PredictedWork, CoarserImagesKeepTheirShape) {
  const std::vector<Camera> coarse = coarser({wide_camera()}, 16);
  EXPECT_EQ(coarse.front().width, 16);
  EXPECT_EQ(coarse.front().height, 8);
  EXPECT_EQ(coarser({wide_camera()}, 4000).front().width, 3000);
}

TEST(PredictedWork, ViewsAndTheConeAboutTheSunAreADirectionEach) {
  SolverOptions options = quick();
  EXPECT_EQ(directions_seen(options, 36), 0);
  options.views = {{"a", {0, 0, 1}}, {"b", {0, 0, -1}}};
  options.circumsolar_half_angle = .1;
  EXPECT_EQ(directions_seen(options, 36), 3);
  options.cameras = {wide_camera()};
  EXPECT_GT(directions_seen(options, 36), 3);
}

TEST(PredictedWork, LevelsBetweenAreWithoutBottomAndTop) {
  SolverOptions options = quick();
  options.flux_levels = FluxLevels::all;
  EXPECT_THAT(inner_levels(make_box(4, 3, 3), options), testing::ElementsAre(1, 2));
  options.flux_levels = FluxLevels::boundaries;
  EXPECT_THAT(inner_levels(make_box(4, 3, 3), options), testing::IsEmpty());
}

TEST(PredictedWork, TheLargestLevelHasTheMostCells) {
  const BoxGrid box = make_box(2, 2, 3);
  EXPECT_EQ(cells_of_largest_level(make_grid(box, {0, 0, 1, 0, 1, 1, 0, 1, 1, 0, 0, 1}, .9)), 3);
}

TEST(PredictedWork, FewCellsAreOfOneThread) {
  SolverOptions options = quick();
  options.threads = 64;
  const Problem problem = cloudy();
  EXPECT_EQ(threads_of(SolvePlan(problem, options)), 1);
}

}  // namespace
}  // namespace cloudbow
