// Extinction of water and sums over columns. Truth: values worked out by hand.
#include <gtest/gtest.h>

#include <vector>

#include "cloudbow/medium/cloud_amounts.hpp"

namespace cloudbow {
namespace {

/// Two columns of two voxels, each 50 m high, g/m3: 0.5 above 0.25, and 1 above nothing.
CloudField water() {
  return make_cloud_field({2, 1, 2}, {100, 100, 50}, {0, 0, 0}, {0.25F, 0, 0.5F, 1}, "liquid_water_content");
}

// The efficiency of extinction is 2: droplets of radius r have the cross-section 2 pi r^2 and the mass 4/3 pi r^3 rho.
TEST(CloudAmounts, ExtinctionOfWater) {
  const double r = 10e-6, rho = 1e6;  // m, g/m3
  EXPECT_NEAR(extinction_per_liquid_water(10), 2 * r * r / (4. / 3 * r * r * r * rho), 1e-15);
}

TEST(CloudAmounts, WaterBecomesExtinctionVoxelByVoxel) {
  CloudField field = water();
  water_to_extinction(field, std::vector<double>{0.1, 0.2, 0.4});
  EXPECT_EQ(field.value, (std::vector<float>{0.025F, 0.1F, 0.4F}));
  field = water();
  water_to_extinction_by_radius(field, std::vector<float>{15, 7.5F, 3});
  EXPECT_EQ(field.value, (std::vector<float>{0.025F, 0.1F, 0.5F}));
}

TEST(CloudAmounts, SumsOverColumns) {
  const ColumnFigures figures = column_figures(water(), 0.1);
  EXPECT_NEAR(figures.sum, 0.1 * 50 * (0.25 + 0.5 + 1), 1e-12);
  EXPECT_NEAR(figures.largest, 0.1 * 50, 1e-12);
  EXPECT_EQ(largest_value(water()), 1);
}

TEST(CloudAmounts, IceIsLighterThanWater) {
  EXPECT_EQ(density_of_water("liquid_water_content"), 1);
  EXPECT_EQ(density_of_water("rain_water_content"), 1);
  for (const char* quantity : {"ice_water_content", "snow_water_content", "graupel_water_content"})
    EXPECT_EQ(density_of_water(quantity), .917) << quantity;
  EXPECT_FALSE(density_of_water("extinction"));
  EXPECT_EQ(water_contents().size(), 5U);
}

}  // namespace
}  // namespace cloudbow
