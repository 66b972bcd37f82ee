// Numbers that no cloud has. Truth: the limits that the header states, and the sizes of the units.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cloudbow/medium/plausibility.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

TEST(Plausibility, DoubtsWaterAboveItsLimitAlone) {
  EXPECT_FALSE(doubt_water_content(20));
  EXPECT_THAT(doubt_water_content(20.1).value(), HasSubstr("liquid water content of 20.1 g/m3"));
  EXPECT_THAT(doubt_water_content(2005, "ice_water_content").value(), HasSubstr("ice water content of 2005 g/m3"));
}

TEST(Plausibility, DoubtsVoxelsAboveTheirDepthAlone) {
  EXPECT_FALSE(doubt_optical_depth(1e4));
  EXPECT_THAT(doubt_optical_depth(2e4).value(), HasSubstr("optical depth 2e+04"));
}

TEST(Plausibility, DoubtsRadiiOutsideTheirRangeAlone) {
  EXPECT_FALSE(doubt_effective_radius(smallest_effective_radius_um, largest_effective_radius_um));
  EXPECT_THAT(doubt_effective_radius(.01, 10).value(), HasSubstr("found 0.01 to 10, allowed 0.1 to 5000 um"));
  EXPECT_TRUE(doubt_effective_radius(1, 6000));
  EXPECT_TRUE(doubt_effective_radius(NAN, 10));
}

TEST(Plausibility, UnitsHaveTheirSizeHoweverTheyAreSpelled) {
  for (const char* spelling : {"1/km", "km-1", "km^-1", "km**-1", "km^{-1}", "/km"})
    EXPECT_EQ(scale_of_units("extinction", spelling), 1e-3) << spelling;
  EXPECT_EQ(scale_of_units("extinction", "1/cm"), 100);
  EXPECT_EQ(scale_of_units("liquid_water_content", "kg m^-3"), 1e3);
  EXPECT_EQ(scale_of_units("ice_water_content", "mg/m3"), 1e-3);
  EXPECT_EQ(scale_of_units("liquid_water_content", "1/m"), std::nullopt);
  EXPECT_EQ(scale_of_units("extinction", "g/m3"), std::nullopt);
  EXPECT_EQ(scale_of_units("radius", "1/m"), std::nullopt);
}

}  // namespace
}  // namespace cloudbow
