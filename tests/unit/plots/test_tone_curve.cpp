// From reflectance to a display. Truth: the closed forms of the curves.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "plots/tone_curve.hpp"

namespace cloudbow {
namespace {

TEST(ToneCurve, HasItsClosedForms) {
  EXPECT_EQ(display_level("linear", .3), .3);
  EXPECT_EQ(display_level("linear", 2), 1);
  EXPECT_NEAR(display_level("filmic", 1), .8, 1e-15);
  EXPECT_NEAR(display_level("filmic", 2), .96, 1e-15);
  for (const char* tone : {"linear", "filmic"}) {
    EXPECT_EQ(display_level(tone, 0), 0);
    EXPECT_EQ(display_level(tone, -1), 0);
  }
  EXPECT_THROW(display_level("soft", .5), InputError);
}

TEST(AutomaticExposure, MakesAllButTheBrightestHundredthNoBrighterThanACard) {
  std::vector<float> luminance(101, .25F);
  luminance[7] = 1000.F;
  EXPECT_EQ(automatic_exposure(luminance), 4);
  luminance[8] = 500.F;
  EXPECT_EQ(automatic_exposure(luminance), 1. / 500);
}

TEST(AutomaticExposure, IsOneWithoutLight) {
  EXPECT_EQ(automatic_exposure({}), 1);
  EXPECT_EQ(automatic_exposure({0.F, 0.F}), 1);
  EXPECT_EQ(automatic_exposure({NAN, .5F}), 2) << "pixels that see nothing do not count";
}

}  // namespace
}  // namespace cloudbow
