#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>

#include "transport/problem/finite.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

Solution of_two_levels() {
  Solution solution;
  solution.box = make_box(2, 2, 1);
  solution.flux_level = {0, 1};
  solution.upwelling_flux.assign(8, 1.F);
  return solution;
}

std::string refused(const Solution& solution) {
  try {
    check_finite(solution);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Finite, NumbersPass) { EXPECT_EQ(refused(of_two_levels()), ""); }

TEST(Finite, MessageNamesVariableAndPlace) {
  Solution solution = of_two_levels();
  solution.upwelling_flux[6] = std::numeric_limits<float>::quiet_NaN();
  const std::string message = refused(solution);
  EXPECT_NE(message.find("upwelling_flux at 1 m, column (0, 1)"), std::string::npos) << message;
}

TEST(Finite, LedgerIsChecked) {
  Solution solution = of_two_levels();
  solution.ledger.absorptance = std::numeric_limits<double>::infinity();
  EXPECT_NE(refused(solution).find("absorptance"), std::string::npos);
}

// The corners of a fisheye's image look nowhere: they are NaN by definition. Its middle is not.
TEST(Finite, PixelsThatLookNowhereAreNone) {
  Solution solution = of_two_levels();
  CameraImage image;
  image.camera.projection = Camera::Projection::fisheye;
  image.camera.width = image.camera.height = 9;
  image.radiance.assign(81, 1.F);
  image.radiance[0] = std::numeric_limits<float>::quiet_NaN();
  solution.camera_images = {image};
  EXPECT_EQ(refused(solution), "");
  solution.camera_images[0].radiance[40] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(refused(solution).find("pixel (4, 4)"), std::string::npos);
}

}  // namespace
}  // namespace cloudbow
