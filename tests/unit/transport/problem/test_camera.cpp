// Geometry of cameras. Truth: the definitions of the projections at their centres, edges and corners.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cloudbow/core/error.hpp"
#include "cloudbow/transport/camera.hpp"

namespace cloudbow {
namespace {

using Projection = Camera::Projection;

constexpr double degree = std::numbers::pi / 180;
constexpr double rounding = 1e-14;  // a few operations on numbers of order 1

void expect_direction(const std::optional<Direction>& found, const Eigen::Vector3d& expected) {
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->norm(), 1, rounding);
  EXPECT_NEAR((*found - expected.normalized()).norm(), 0, rounding) << found->transpose();
}

// Looks north from 1 km up: east is to the right.
Camera northward(Projection projection, double degrees, int width, int height) {
  return make_camera("c", projection, {{500, 0, 1000}, {500, 2000, 1000}}, degrees * degree, width, height);
}

Camera upward(double degrees, int width, int height) {
  return make_camera("c", Projection::fisheye, {{0, 0, 0}, {0, 0, 1}, {0, 1, 0}}, degrees * degree, width, height);
}

TEST(Camera, FrameIsOrthonormalAndRightHanded) {
  for (const auto projection : {Projection::perspective, Projection::fisheye, Projection::panorama}) {
    const Camera camera = make_camera("c", projection, {{3, -4, 5}, {30, 17, 1}, {.2, -.1, 3}}, 1, 4, 3);
    Eigen::Matrix3d frame;
    frame << camera.right, camera.up, -camera.forward;
    EXPECT_NEAR((frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm(), 0, rounding);
    EXPECT_NEAR(frame.determinant(), 1, rounding);
  }
}

TEST(Camera, PerspectiveKeepsTheLineOfSightAndPanoramaTheAxis) {
  const CameraPlacement down{{0, 0, 100}, {100, 0, 0}, {0, 0, 2}};
  const Camera perspective = make_camera("c", Projection::perspective, down, 1, 4, 4);
  EXPECT_NEAR((perspective.forward - Eigen::Vector3d(1, 0, -1).normalized()).norm(), 0, rounding);
  EXPECT_NEAR((perspective.up - Eigen::Vector3d(1, 0, 1).normalized()).norm(), 0, rounding);
  const Camera panorama = make_camera("c", Projection::panorama, down, 1, 4, 4);
  EXPECT_NEAR((panorama.forward - Eigen::Vector3d(1, 0, 0)).norm(), 0, rounding);
  EXPECT_NEAR((panorama.up - Eigen::Vector3d(0, 0, 1)).norm(), 0, rounding);
}

TEST(Camera, PerspectiveCornersAreTangents) {
  const Camera camera = northward(Projection::perspective, 70, 300, 200);
  const double t = std::tan(35 * degree);
  expect_direction(line_of_sight(camera, 150, 100), {0, 1, 0});
  expect_direction(line_of_sight(camera, 0, 100), {-t, 1, 0});
  expect_direction(line_of_sight(camera, 300, 100), {t, 1, 0});
  // Square pixels: the image's height is 2/3 of its width.
  expect_direction(line_of_sight(camera, 0, 0), {-t, 1, t * 2 / 3});
  expect_direction(line_of_sight(camera, 300, 200), {t, 1, -t * 2 / 3});
}

TEST(Camera, FisheyeIsEquidistant) {
  const Camera camera = upward(180, 200, 100);
  expect_direction(line_of_sight(camera, 100, 50), {0, 0, 1});
  // Seen from below with north on top, east is on the left.
  expect_direction(line_of_sight(camera, 100, 0), {0, 1, 0});
  expect_direction(line_of_sight(camera, 50, 50), {1, 0, 0});
  expect_direction(line_of_sight(camera, 150, 50), {-1, 0, 0});
  const double s = std::sin(30 * degree), c = std::cos(30 * degree);
  expect_direction(line_of_sight(camera, 100, 50 + 50. / 3), {0, -s, c});
  expect_direction(
      line_of_sight(camera, 100 - 10 * std::sqrt(2.), 50 - 10 * std::sqrt(2.)),
      {std::sin(36 * degree) * std::sqrt(.5), std::sin(36 * degree) * std::sqrt(.5), std::cos(36 * degree)});
}

TEST(Camera, NothingOutsideTheCircleOfAFisheye) {
  const Camera camera = upward(180, 200, 100);
  EXPECT_FALSE(line_of_sight(camera, 49.999, 50));
  EXPECT_FALSE(line_of_sight(camera, 0, 0));
  EXPECT_FALSE(line_of_sight(camera, 100 + 36, 50 + 36));  // 36 sqrt(2) > 50
  EXPECT_TRUE(line_of_sight(camera, 100 + 35, 50 + 35));
}

TEST(Camera, FullFisheyeLooksBackAtItsRim) { expect_direction(line_of_sight(upward(360, 10, 10), 5, 0), {0, 0, -1}); }

TEST(Camera, PanoramaGoesRoundToTheRight) {
  const Camera camera = northward(Projection::panorama, 60, 400, 100);
  expect_direction(line_of_sight(camera, 200, 50), {0, 1, 0});   // north in the middle
  expect_direction(line_of_sight(camera, 300, 50), {1, 0, 0});   // then east
  expect_direction(line_of_sight(camera, 100, 50), {-1, 0, 0});  // west to its left
  expect_direction(line_of_sight(camera, 0, 50), {0, -1, 0});    // both edges look south
  expect_direction(line_of_sight(camera, 400, 50), {0, -1, 0});
  expect_direction(line_of_sight(camera, 200, 0), {0, std::cos(30 * degree), std::sin(30 * degree)});
  expect_direction(line_of_sight(camera, 300, 75), {std::cos(15 * degree), 0, -std::sin(15 * degree)});
}

TEST(Camera, PlacementsWithoutAFrameAreTold) {
  const auto place = [](const CameraPlacement& placement) {
    return make_camera("c", Projection::perspective, placement, 1, 4, 4);
  };
  EXPECT_THROW(place({{1, 2, 3}, {1, 2, 3}}), InputError);
  EXPECT_THROW(place({{1, 2, 3}, {1, 2, 30}}), InputError);
  EXPECT_THROW(place({{1, 2, 3}, {1, 2, -30}}), InputError);
  EXPECT_THROW(place({{1, 2, 3}, {4, 5, 6}, {0, 0, 0}}), InputError);
  EXPECT_NO_THROW(place({{1, 2, 3}, {1, 2, 30}, {0, 1, 0}}));
}

}  // namespace
}  // namespace cloudbow
