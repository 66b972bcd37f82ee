// Slopes from first moments. The truth is light whose slope is known.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "transport/rays/slope_fit.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

const BoxGrid slope_box = make_box(7, 5, 3);

std::vector<PathPattern> patterns_of_octant() {
  std::vector<PathPattern> patterns;
  for (const auto& [mu, azimuth] : {std::pair{-.9, 10.}, {-.6, 25.}, {-.6, 70.}, {-.3, 40.}, {-.15, 80.}, {-.1, 5.}})
    patterns.push_back(make_path_pattern(slope_box, travel_along(mu, azimuth), .3, .6, false, {0, 3}));
  return patterns;
}

// First moment of I = 1 + g . r over the segments of a level, by Simpson's rule: exact for a product of two linear
// functions.
Eigen::Vector3d moment_of(const PathPattern& pattern, int step, const Eigen::Vector3d& g) {
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (std::uint32_t s = pattern.level_begin[step]; s < pattern.level_begin[step + 1]; ++s) {
    const Segment& segment = pattern.segments[s];
    const Eigen::Vector3d a(segment.from.data()), b(segment.to.data()), m = (a + b) / 2;
    moment += segment.fraction / 6 * (a * (1 + g.dot(a)) + 4 * m * (1 + g.dot(m)) + b * (1 + g.dot(b)));
  }
  return moment;
}

TEST(SlopeFit, MomentOfLinearLightIsTheSpreadTimesItsSlope) {
  const Eigen::Vector3d g(.4, -.7, 1.1);
  for (const PathPattern& pattern : patterns_of_octant()) {
    for (int step = 0; step < 3; ++step)
      EXPECT_LT((spread_of_places(pattern, step) * g - moment_of(pattern, step, g)).norm(), 1e-14);
  }
}

TEST(SlopeFit, DirectionsOfAnOctantFindTheSlopeThatOneCannot) {
  const Eigen::Vector3d g(.4, -.7, 1.1);
  for (int step = 0; step < 3; ++step) {
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    for (const PathPattern& pattern : patterns_of_octant()) {
      spread += spread_of_places(pattern, step);
      moment += moment_of(pattern, step, g);
    }
    EXPECT_LT((regular_inverse(spread, 6) * moment - g).norm(), .05) << "what regularisation takes";
  }
  // A vertical ray has no places but along z.
  const PathPattern vertical = make_path_pattern(slope_box, Direction(0, 0, -1), .5, .5, false, {0, 3});
  const Eigen::Matrix3d spread = spread_of_places(vertical, 1);
  EXPECT_NEAR(spread(2, 2), 1. / 12, 1e-15);
  const Eigen::Vector3d found = regular_inverse(spread) * moment_of(vertical, 1, g);
  EXPECT_NEAR(found.x(), 0, 1e-15);
  EXPECT_NEAR(found.z(), g.z(), 1e-3 * g.z());  // (1/12)^2 / ((1/12)^2 + (2e-3)^2)
}

TEST(SlopeFit, RegularInverseBoundsEveryEigenvalue) {
  // v / (v^2 + e^2) is at most 1 / (2 e).
  for (const double small : {0., 1e-9, 1e-3, 2e-3, 1e-2}) {
    const Eigen::Matrix3d spread = Eigen::Vector3d(.08, .05, small).asDiagonal();
    const Eigen::Matrix3d inverse = regular_inverse(spread);
    EXPECT_NEAR(inverse(2, 2), small / (small * small + 4e-6), 1e-9);
    EXPECT_LE(inverse(2, 2), 250 + 1e-9);
    EXPECT_NEAR(inverse(0, 0), .08 / (.0064 + 4e-6), 1e-9);
  }
}

TEST(SlopeFit, TruePlacesAreFromTheCentreOfTheCell) {
  const PathPattern centred = make_path_pattern(slope_box, travel_along(-.6, 25), .3, .6, false, {0, 3});
  const PathPattern placed = at_true_places(centred);
  // Light enters at the launch fractions.
  EXPECT_NEAR(placed.segments.front().from[0], .3 - .5, 1e-14);
  EXPECT_NEAR(placed.segments.front().from[1], .6 - .5, 1e-14);
  for (std::uint32_t s = 0; s < placed.segments.size(); ++s) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_LE(std::abs(placed.segments[s].from[axis]), .5 + 1e-9) << "a place in the cell";
      EXPECT_NEAR(placed.segments[s].to[axis] - placed.segments[s].from[axis],
                  centred.segments[s].to[axis] - centred.segments[s].from[axis], 1e-14);
    }
  }
}

}  // namespace
}  // namespace cloudbow
