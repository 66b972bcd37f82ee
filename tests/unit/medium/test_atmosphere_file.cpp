// Profiles of the air from files. Truth: the numbers of the files in their units.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

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
  // The gas law gives 2.55e25 m-3.
  for (const char* air : {"2.5e16", "2.5e25", "inf"}) {
    EXPECT_THAT(message(text(fmt::format("0 1013 288 {} 1e11\n1 900 280 2.3e19 1e11\n", air))),
                HasSubstr("column air: contradicts the gas law"));
  }
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
