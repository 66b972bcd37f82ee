// Directions of travel. Truth: sines and cosines of angles that have closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "cloudbow/sphere/travel.hpp"

namespace cloudbow {
namespace {

TEST(Travel, LightTravelsAwayFromItsPlaceInTheSky) {
  const double s = std::sin(std::acos(-1.0) / 3);  // 60 degrees
  EXPECT_NEAR((travel_from(60, 0) - Direction(-s, 0, -0.5)).norm(), 0, 1e-15);
  EXPECT_NEAR((travel_from(60, 90) - Direction(0, -s, -0.5)).norm(), 0, 1e-15);
  EXPECT_EQ(travel_from(0, 123).z(), -1);
  EXPECT_NEAR((travel_from(120, 0) - Direction(-s, 0, 0.5)).norm(), 0, 1e-15);  // from below
}

}  // namespace
}  // namespace cloudbow
