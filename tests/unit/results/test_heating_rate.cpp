// Heating of the air. Truth: P / (rho c_p) with densities of an isothermal atmosphere, which are exponentials.
#include <gtest/gtest.h>

#include <cmath>

#include "cloudbow/results/heating_rate.hpp"

namespace cloudbow {
namespace {

constexpr double scale_height_m = 8000, surface_pa = 1e5, kelvin = 280;
constexpr double gas_constant = 287.05;  // J kg-1 K-1, of dry air; its digits differ by 1e-4 between tables

Atmosphere isothermal() {
  Atmosphere air;
  for (const double z : {0., 40000.}) {
    air.height_m.push_back(z);
    air.pressure_pa.push_back(surface_pa * std::exp(-z / scale_height_m));
    air.temperature_k.push_back(kelvin);
  }
  return air;
}

/// Mean of an exponential between two heights.
double mean_of(double bottom_m, double top_m) {
  const double at_ground = surface_pa / gas_constant / kelvin;
  return at_ground * scale_height_m * (std::exp(-bottom_m / scale_height_m) - std::exp(-top_m / scale_height_m)) /
         (top_m - bottom_m);
}

TEST(HeatingRate, DensityIsTheMeanOfThinAndTallLevels) {
  for (const auto& [bottom, top] : {std::pair(0., 25.), std::pair(3000., 11000.), std::pair(0., 40000.)})
    EXPECT_NEAR(mean_density(isothermal(), bottom, top) / mean_of(bottom, top), 1, 2e-4) << bottom << ' ' << top;
}

TEST(HeatingRate, IsPowerOverHeatCapacity) {
  Solution solution;
  solution.box.nx = 2;
  solution.box.z_edge_m = {0, 100, 2100};
  solution.absorbed_power = {.1F, .3F, -.2F, 0};
  const HeatingRate rate = heating_rate(solution, isothermal());
  const double low = 1004 * mean_of(0, 100), high = 1004 * mean_of(100, 2100);
  ASSERT_EQ(rate.cell.size(), 4U);
  EXPECT_NEAR(rate.cell[0] * low, .1, 2e-5);
  EXPECT_NEAR(rate.cell[2] * high, -.2, 4e-5);
  EXPECT_EQ(rate.cell[3], 0);
  ASSERT_EQ(rate.profile.size(), 2U);
  EXPECT_NEAR(rate.profile[0] * low, .2, 4e-5);
  EXPECT_NEAR(rate.profile[1] * high, -.1, 2e-5);
}

}  // namespace
}  // namespace cloudbow
