// Profiles of the air. Truth: the tables of the U.S. Standard Atmosphere 1976, and the numbers in the files that the
// tests write.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "../near_with_report.hpp"
#include "cloud_test_tools.hpp"
#include "cloudbow/medium/atmosphere.hpp"
#include "netcdf_builder.hpp"

namespace cloudbow {
namespace {

namespace fs = std::filesystem;
using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

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
      "scene.toml: [atmosphere]: height: too few (found 1, allowed at least 2) give the lowest and the highest at "
      "least");
  EXPECT_EQ(
      message([](Atmosphere& air) { air.temperature_k.pop_back(); }),
      "scene.toml: [atmosphere]: temperature: not as many values as heights (found 2, allowed 3) give one for each "
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

class AtmosphereFile : public testing::Test {
 protected:
  AtmosphereFile() { fs::create_directories(folder_); }
  ~AtmosphereFile() override { fs::remove_all(folder_); }

  fs::path text(const std::string& content) const {
    fs::path file = folder_ / "profile.txt";
    std::ofstream(file) << content;
    return file;
  }
  fs::path netcdf_path() const { return folder_ / "profile.nc"; }
  static std::string message(const fs::path& file) {
    return message_of([&] { read_atmosphere(file); });
  }

  const fs::path folder_ = fs::temp_directory_path() / ("cloudbow_atmosphere_" + std::to_string(::getpid()));
};

/// AFGL-TR-86-0110, midlatitude summer, some of its heights.
constexpr const char* midlatitude_summer =
    R"(# AFGL atmospheric constituent profile. midlatitude summer. ( AFGL-TR-86-0110)
#     z(km)      p(mb)        T(K)    air(cm-3)    o3(cm-3)     o2(cm-3)    h2o(cm-3)    co2(cm-3)     no2(cm-3)
120.000     0.00002     380.000 4.326673E+11 2.165000E+02 3.139250E+10 8.660000E+04 1.515500E+07 6.538300E+01
13.000   179.00000     215.800 6.007772E+18 1.803600E+12 1.256508E+18 4.809600E+13 1.983960E+15 2.675340E+08
1.000   902.00000     289.700 2.255121E+19 7.531609E+11 4.717130E+18 3.110146E+17 7.448100E+15 5.191100E+08
0.000  1013.00000     294.200 2.493898E+19 7.530432E+11 5.216640E+18 4.682496E+17 8.236800E+15 5.740800E+08
)";

TEST_F(AtmosphereFile, ReadsProfilesOfTheAfgl) {
  const Atmosphere air = read_atmosphere(text(midlatitude_summer));
  EXPECT_THAT(air.height_m, ElementsAre(0, 1000, 13000, 120000));
  EXPECT_THAT(air.temperature_k, ElementsAre(294.2, 289.7, 215.8, 380));
  EXPECT_THAT(air.pressure_pa, ElementsAre(DoubleEq(101300), DoubleEq(90200), DoubleEq(17900), DoubleEq(.002)));
  EXPECT_THAT(air.mole_fraction, SizeIs(5));
  EXPECT_DOUBLE_EQ(air.mole_fraction.at("h2o").front(), 4.682496e17 / 2.493898e19);
  EXPECT_DOUBLE_EQ(air.mole_fraction.at("o3").front(), 7.530432e11 / 2.493898e19);
  EXPECT_DOUBLE_EQ(air.mole_fraction.at("co2").back(), 1.5155e7 / 4.326673e11);
}

TEST_F(AtmosphereFile, WithoutAHeadingHasTheOrderOfTheAfgl) {
  const Atmosphere three = read_atmosphere(text("# made up\n0 1013.25 288\n\n  2, 795, 275.0D0\n"));
  EXPECT_THAT(three.height_m, ElementsAre(0, 2000));
  EXPECT_THAT(three.pressure_pa, ElementsAre(DoubleEq(101325), DoubleEq(79500)));
  EXPECT_THAT(three.temperature_k, ElementsAre(288, 275));
  EXPECT_THAT(three.mole_fraction, SizeIs(0));
  const Atmosphere five = read_atmosphere(text("0 1013.25 288 2.5e19 5e11\n2 795 275 2e19 6e11\n"));
  EXPECT_THAT(five.mole_fraction.at("o3"), ElementsAre(DoubleEq(2e-8), DoubleEq(3e-8)));
}

TEST_F(AtmosphereFile, TakesColumnsAndUnitsFromItsHeading) {
  const Atmosphere air = read_atmosphere(text(
      "# T(degC)  pressure (Pa) altitude(m) wind(m/s) co2(ppm) H2O(mol/mol)\n15 101325 0 3 420 .01\n2 80000 2000 5 "
      "400 .005\n"));
  EXPECT_THAT(air.height_m, ElementsAre(0, 2000));
  EXPECT_THAT(air.pressure_pa, ElementsAre(101325, 80000));
  EXPECT_THAT(air.temperature_k, ElementsAre(DoubleEq(288.15), DoubleEq(275.15)));
  EXPECT_THAT(air.mole_fraction, SizeIs(2));
  EXPECT_THAT(air.mole_fraction.at("co2"), ElementsAre(DoubleEq(420e-6), DoubleEq(400e-6)));
  EXPECT_THAT(air.mole_fraction.at("h2o"), ElementsAre(.01, .005));
}

TEST_F(AtmosphereFile, NamesTheLineThatIsWrong) {
  const std::string name = (folder_ / "profile.txt").string();
  EXPECT_EQ(message(text("# a\n0 1013 288\n1 900 x\n")),
            name + ":3: column 3: not a number (found \"x\", allowed a number) comments begin with #");
  EXPECT_THAT(message(text("0 1013 288\n1 900\n")), HasSubstr(":2: wrong number of columns (found 2, allowed 3"));
  EXPECT_THAT(message(text("0 1013\n")), HasSubstr(":1: columns not known (found 2, allowed 3 to 9"));
  EXPECT_THAT(message(text("")), HasSubstr("no profile"));
  EXPECT_THAT(message(text("# z(km) p(atm) T(K)\n")), HasSubstr(":1: column p: unit not known (found \"atm\""));
  EXPECT_THAT(message(text("# z p T o3 o3\n")), HasSubstr(":1: column o3: is there twice"));
  EXPECT_THAT(message(text("# z p T o3\n0 1013 288 1e11\n1 900 280 1e11\n")),
              HasSubstr("column o3: no density of the air for it"));
  EXPECT_THAT(message(text("0 1013 288 0 1e11\n1 900 280 1e19 1e11\n")), HasSubstr("column air: not positive"));
  EXPECT_THAT(message(text("0 1013 nan\n1 900 280\n")), HasSubstr("temperature: out of range (found nan K at 0 m"));
  EXPECT_THAT(message(text("0 101300 288\n1 90000 280\n")), HasSubstr("pressure: out of range (found 1.013e+07 Pa"));
  EXPECT_THAT(message(folder_), HasSubstr("a profile of the air as text columns or netCDF"));
}

TEST_F(AtmosphereFile, ReadsNetcdfByNamesAndUnits) {
  NetcdfBuilder builder(netcdf_path());
  builder.dimension("lev", 3);
  builder.dimension("time", 1);
  builder.variable("z", {"lev"}, "km", {10, 2, 0}, NC_DOUBLE);
  builder.variable("pressure", {"time", "lev"}, "hPa", {265, 795, 1013.25}, NC_DOUBLE);
  builder.variable("T", {"lev"}, "degC", {-50, 2, 15}, NC_DOUBLE);
  builder.variable("h2o", {"lev"}, "", {0, .001, .01}, NC_DOUBLE);
  builder.variable("CO2", {"lev"}, "ppm", {400, 410, 420}, NC_DOUBLE);
  const Atmosphere air = read_atmosphere(builder.close());
  EXPECT_THAT(air.height_m, ElementsAre(0, 2000, 10000));
  EXPECT_THAT(air.pressure_pa, ElementsAre(DoubleEq(101325), DoubleEq(79500), DoubleEq(26500)));
  EXPECT_THAT(air.temperature_k, ElementsAre(DoubleEq(288.15), DoubleEq(275.15), DoubleEq(223.15)));
  EXPECT_THAT(air.mole_fraction.at("h2o"), ElementsAre(.01, .001, 0));
  EXPECT_THAT(air.mole_fraction.at("co2"), ElementsAre(DoubleEq(420e-6), DoubleEq(410e-6), DoubleEq(400e-6)));
}

TEST_F(AtmosphereFile, ReadsNetcdfByStandardNames) {
  NetcdfBuilder builder(netcdf_path());
  builder.dimension("level", 2);
  builder.variable("a", {"level"}, "m", {0, 2000}, NC_DOUBLE);
  builder.text("a", "standard_name", "altitude");
  builder.variable("b", {"level"}, "Pa", {101325, 79500}, NC_DOUBLE);
  builder.text("b", "standard_name", "air_pressure");
  builder.variable("c", {"level"}, "K", {288, 275}, NC_DOUBLE);
  builder.text("c", "standard_name", "air_temperature");
  builder.variable("d", {"level"}, "1e-6", {.03, .04}, NC_DOUBLE);
  builder.text("d", "standard_name", "mole_fraction_of_ozone_in_air");
  builder.variable("mole_fraction_of_methane_in_air", {"level"}, "1", {1.9e-6, 1.8e-6}, NC_DOUBLE);
  const Atmosphere air = read_atmosphere(builder.close());
  EXPECT_THAT(air.height_m, ElementsAre(0, 2000));
  EXPECT_THAT(air.pressure_pa, ElementsAre(101325, 79500));
  EXPECT_THAT(air.temperature_k, ElementsAre(288, 275));
  EXPECT_THAT(air.mole_fraction.at("o3"), ElementsAre(DoubleEq(3e-8), DoubleEq(4e-8)));
  EXPECT_THAT(air.mole_fraction.at("ch4"), ElementsAre(1.9e-6, 1.8e-6));
}

TEST_F(AtmosphereFile, SaysWhatANetcdfFileLacks) {
  const auto made = [&](const std::string& unit_of_height, bool with_temperature, std::size_t levels) {
    NetcdfBuilder builder(netcdf_path());
    builder.dimension("level", 2);
    builder.dimension("x", levels);
    builder.variable("z", {"level"}, unit_of_height, {0, 2000});
    builder.variable("p", {"level", "x"}, "Pa", std::vector<double>(2 * levels, 9e4));
    if (with_temperature) builder.variable("T", {"level"}, "K", {288, 275});
    return builder.close();
  };
  EXPECT_THAT(message(made("m", false, 1)), HasSubstr("temperature: no such variable (found z, p, allowed T, t, TABS"));
  EXPECT_THAT(message(made("feet", true, 1)), HasSubstr("'z': unit not known (found \"feet\", allowed m, km)"));
  EXPECT_THAT(message(made("m", true, 2)), HasSubstr("'p': not one profile (found 2 dimensions longer than 1"));
  EXPECT_THAT(message(made("m", true, 1)), HasSubstr("pressure: not in order"));
  std::ofstream(netcdf_path()) << "CDF\1 and nothing else";
  EXPECT_THAT(message(netcdf_path()), HasSubstr("profile.nc"));
}

}  // namespace
}  // namespace cloudbow
