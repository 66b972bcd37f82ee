// Profiles of the air. Truth: the tables of the U.S. Standard Atmosphere 1976, and the numbers in the files that the
// tests write.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "../near_with_report.hpp"
#include "cloud_test_tools.hpp"
#include "cloudbow/medium/atmosphere.hpp"
#include "netcdf_builder.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

constexpr double gas_constant = 287.05;

TEST(Atmosphere, StandardAgreesWithItsPublishedTable) {
  struct Row {
    double height_m, kelvin, hpa;
  };
  // NOAA-S/T 76-1562 (1976), table I: geometric altitude, temperature, pressure.
  const Atmosphere air = us_standard_1976();
  for (const Row& row : {Row{0, 288.150, 1013.25}, Row{5000, 255.676, 540.48}, Row{10000, 223.252, 265.00},
                         Row{11000, 216.774, 227.00}, Row{20000, 216.650, 55.293}, Row{30000, 226.509, 11.970},
                         Row{32000, 228.490, 8.8906}, Row{40000, 250.350, 2.8714}, Row{47000, 269.684, 1.1585},
                         Row{50000, 270.650, .79779}, Row{60000, 247.021, .21958}, Row{70000, 219.585, .052209},
                         Row{71000, 216.846, .044795}, Row{80000, 198.639, .010524}}) {
    EXPECT_NEAR(air.temperature_at(row.height_m), row.kelvin, .0006) << row.height_m;  // three decimals in the table
    EXPECT_NEAR(air.pressure_at(row.height_m) / (100 * row.hpa), 1, 1e-4) << row.height_m;  // one in the fifth digit
  }
  // The same table, density at sea level: 1.2250 kg m-3 with R = 287.053, here 287.05.
  EXPECT_NEAR(air.density_at(0), 1.2250, 5e-5);
}

TEST(Atmosphere, StandardIsExactBetweenItsHeights) {
  const Atmosphere air = us_standard_1976();
  EXPECT_EQ(air.height_m.front(), -1000);
  EXPECT_EQ(air.height_m.back(), 84800);
  check_atmosphere(air, "standard");
  // The troposphere in closed form, from its lapse rate in geopotential metres.
  for (double z = -1000; z < 11000; z += 37) {
    const double geopotential = 6356766 * z / (6356766 + z), kelvin = 288.15 - 6.5e-3 * geopotential;
    EXPECT_NEAR(air.temperature_at(z), kelvin, .01);
    EXPECT_NEAR(air.pressure_at(z) / (101325 * std::pow(kelvin / 288.15, 9.80665 * 28.9644 / 8314.32 / 6.5e-3)), 1,
                1e-4);
  }
  // dp = -rho g dz with g at that height; R of the table, not of density_at. Over 100 m, in the middle of steps.
  for (double z = -930; z < 84000; z += 510) {
    const double gravity = 9.80665 * std::pow(6356766 / (6356766 + z), 2);
    const double fall = std::log(air.pressure_at(z - 50) / air.pressure_at(z + 50)) / 100;
    EXPECT_NEAR(fall / (gravity / (8314.32 / 28.9644 * air.temperature_at(z))), 1, .006) << z;  // of half a step
  }
}

TEST(Atmosphere, IsLinearBetweenHeightsAndGoesOnBeyondThem) {
  const Atmosphere air{{0, 1000, 3000}, {100000, 90000, 70000}, {290, 280, 250}, {}};
  EXPECT_DOUBLE_EQ(air.temperature_at(500), 285);
  EXPECT_DOUBLE_EQ(air.temperature_at(2000), 265);
  EXPECT_DOUBLE_EQ(air.temperature_at(1000), 280);
  EXPECT_DOUBLE_EQ(air.temperature_at(-500), 290);
  EXPECT_DOUBLE_EQ(air.temperature_at(9000), 250);
  EXPECT_DOUBLE_EQ(air.pressure_at(500), std::sqrt(100000. * 90000.));
  EXPECT_DOUBLE_EQ(air.pressure_at(-1000), 100000. * 100000 / 90000);
  EXPECT_DOUBLE_EQ(air.pressure_at(5000), 70000. * 70000 / 90000);
  EXPECT_DOUBLE_EQ(air.density_at(1000), 90000 / (gas_constant * 280));
}

TEST(Atmosphere, RefusesWhatIsNoAir) {
  const Atmosphere sound{{0, 1000, 3000}, {100000, 90000, 70000}, {290, 280, 250}, {{"h2o", {.01, .005, 0}}}};
  check_atmosphere(sound, "a");
  const auto message = [&](auto change) {
    Atmosphere air = sound;
    change(air);
    return message_of([&] { check_atmosphere(air, "scene.toml: [atmosphere]"); });
  };
  EXPECT_EQ(
      message([](Atmosphere& air) {
        air = {{0}, {100000}, {290}, {}};
      }),
      "scene.toml: [atmosphere]: height: too few (found 1, allowed at least 2); give the lowest and the highest at "
      "least");
  EXPECT_EQ(
      message([](Atmosphere& air) { air.temperature_k.pop_back(); }),
      "scene.toml: [atmosphere]: temperature: not as many values as heights (found 2, allowed 3); give one for each "
      "height");
  EXPECT_THAT(message([](Atmosphere& air) {
                air.height_m = {0, 3000, 1000};
              }),
              HasSubstr("height: not in order (found 1000 m after 3000 m, allowed ascending heights)"));
  EXPECT_THAT(message([](Atmosphere& air) { air.height_m = {0, NAN, 1000}; }), HasSubstr("height: out of range"));
  EXPECT_THAT(message([](Atmosphere& air) { air.pressure_pa[1] = 100000; }),
              HasSubstr("pressure: not in order (found 100000 Pa at 0 m, 100000 Pa at 1000 m, allowed falling"));
  EXPECT_THAT(message([](Atmosphere& air) {
                air.pressure_pa = {1000, 900, 700};
              }),
              HasSubstr("pressure: too low for its height (found 1000 Pa at 0 m, allowed from 3.38e+04 Pa) in hPa?"));
  EXPECT_THAT(message([](Atmosphere& air) { air.pressure_pa[0] = 120001; }), HasSubstr("allowed 0.0001 to 120000 Pa)"));
  EXPECT_THAT(message([](Atmosphere& air) { air.pressure_pa[2] = 0; }), HasSubstr("pressure: out of range"));
  EXPECT_THAT(message([](Atmosphere& air) { air.height_m = {0, 1, 3}; }), HasSubstr("in km? give m"));
  EXPECT_THAT(message([](Atmosphere& air) {
                air.height_m = {0, 1e5, 3e5};
              }),
              HasSubstr("pressure: contradicts the heights"));
  EXPECT_THAT(message([](Atmosphere& air) {
                air.temperature_k = {17, 7, -23};
              }),
              HasSubstr("temperature: out of range (found 17 K at 0 m, allowed 100 to 400 K) in degrees Celsius?"));
  EXPECT_THAT(message([](Atmosphere& air) { air.mole_fraction["h2o"][0] = 1.5; }),
              HasSubstr("h2o: out of range (found 1.5 mol/mol at 0 m, allowed 0 to 1 mol/mol)"));
  EXPECT_THAT(message([](Atmosphere& air) { air.mole_fraction["o3"] = {0}; }), HasSubstr("o3: not as many values"));
}

}  // namespace
}  // namespace cloudbow
