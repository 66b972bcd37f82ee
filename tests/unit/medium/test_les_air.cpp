// Air of LES files. Truth: closed forms of the isentropic atmosphere.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "les_test_tools.hpp"

namespace cloudbow {
namespace {

using namespace les_test;
using testing::HasSubstr;
using testing::Not;

TEST_F(LesImport, ThePressureOfPalmIsAPerturbation) {
  CloudImportOptions options = with(
      [](NetcdfBuilder& file) {
        file.text("", "title", "PALM");
        add_water(file, "ql");
        file.variable("p", {"z"}, "Pa", profile([](int k) { return 0.3 - 0.1 * k; }));
        file.variable("theta", {"z"}, "K", profile([](int) { return theta; }));
      },
      false);
  EXPECT_THAT(error_of(options), AllOf(HasSubstr("needs the air's density"), HasSubstr("--profile FILE")));
}

TEST_F(LesImport, BaseAndPotentialTemperatureMayBeNamed) {
  CloudImportOptions options = with([](NetcdfBuilder& file) {
    file.variable("dp", {"z", "y", "x"}, "Pa", field([](int k, int, int) { return 3.0 * k; }));
    file.text("dp", "long_name", "pressure deviation");
    file.variable("p_mean", {"z"}, "hPa", profile([](int k) { return (pressure(k) - 3.0 * k) / 100; }), NC_DOUBLE);
    file.variable("warmth", {"z"}, "K", profile([](int) { return theta; }));
  });
  options.pressure = "dp";
  options.potential_temperature = "warmth";
  EXPECT_THAT(error_of(options), HasSubstr("--base-pressure"));
  options.base_pressure = "p_mean";
  expect_truth(import_cloud(options));
  options.base_pressure = "p_base";
  EXPECT_THAT(error_of(options), HasSubstr("no variable 'p_base' (as --base-pressure says"));
}

TEST_F(LesImport, TheExnerFunctionGivesThePressure) {
  // RAMS: PI = c_p (p / 1e5 Pa)^(2/7), T = THETA PI / c_p.
  expect_truth(import_cloud(with(
                   [](NetcdfBuilder& file) {
                     add_water(file, "RCP");
                     file.variable("THETA", {"z"}, "K", profile([](int) { return theta; }));
                     file.variable("PI", {"z"}, "J/(kg K)", profile([](int k) { return 1004 * exner(k); }));
                   },
                   false)),
               1, 2e-5);
}

TEST_F(LesImport, MoncsPotentialTemperatureIsADifference) {
  CloudImportOptions options = with(
      [](NetcdfBuilder& file) {
        add_water(file, "q_cloud_liquid_mass");
        file.variable("th", {"z"}, "K", profile([](int k) { return 0.1 * k; }));
        file.variable("thref", {"z"}, "K", profile([](int k) { return theta - 0.1 * k; }));
        file.variable("prefn", {"z"}, "Pa", profile(pressure));
        file.variable("p", {"z"}, "", profile([](int) { return 0.2; }));
      },
      false);
  expect_truth(import_cloud(options));
}

TEST_F(LesImport, LiquidWaterPotentialTemperatureGivesTheDensity) {
  const auto add_thl = [](NetcdfBuilder& file) {
    file.variable("thl", {"z", "y", "x"}, "K",
                  field([](int k, int j, int i) { return theta - 2.5e6 / heat_capacity * water(k, j, i) / exner(k); }));
    file.variable("presf", {"z"}, "Pa", profile(pressure));
    file.text("", "source", "DALES");
  };
  const ImportedCloud cloud = import_cloud(with(
      [&](NetcdfBuilder& file) {
        add_water(file, "ql");
        add_thl(file);
      },
      false));
  expect_truth(cloud);
  EXPECT_THAT(notes_of(cloud), HasSubstr("2488 K times the mixing ratio of the liquid is added"));
}

TEST_F(LesImport, WrfsPerturbationsAndGeopotentialAreRead) {
  NetcdfBuilder file(folder_ / "wrf.nc");
  file.dimension("Time", 1);
  file.dimension("bottom_top", nz);
  file.dimension("bottom_top_stag", nz + 1);
  file.dimension("south_north", ny);
  file.dimension("west_east", nx);
  const std::vector<std::string> whole{"Time", "bottom_top", "south_north", "west_east"};
  const std::vector<std::string> staggered{"Time", "bottom_top_stag", "south_north", "west_east"};
  file.variable("QCLOUD", whole, "kg kg-1", field(water));
  file.variable("P", whole, "Pa", field([](int k, int, int) { return 100 - 20.0 * k; }));
  file.variable("PB", whole, "Pa", field([](int k, int, int) { return pressure(k) - 100 + 20.0 * k; }));
  file.variable("T", whole, "K", field([](int, int, int) { return theta - 300; }));
  file.variable("PH", staggered, "m2 s-2", field([](int k, int, int) { return 3.0 * k; }, nz + 1));
  file.variable("PHB", staggered, "m2 s-2",
                field([](int k, int, int) { return 9.81 * (400 + 40.0 * k) - 3.0 * k; }, nz + 1));
  file.number("", "DX", {100}, NC_FLOAT);
  file.number("", "DY", {100}, NC_FLOAT);
  CloudImportOptions options;
  options.file = file.close();
  const ImportedCloud cloud = import_cloud(options);
  ASSERT_EQ(cloud.field.cells[2], nz);
  // Geopotentials of 32 bits give heights to 1e-4 m of 40 m.
  EXPECT_NEAR(cloud.field.min_m[2], 400, 1e-3);
  EXPECT_NEAR(cloud.field.cell_size_m[2], 40, 1e-3);
  EXPECT_NEAR(cloud.field.value[0] / (1e3 * water(3, 0, 0) * density(3)), 1, 1e-5);
  EXPECT_THAT(notes_of(cloud), HasSubstr("less 300 K"));
  EXPECT_THAT(notes_of(cloud), HasSubstr("('P' + 'PB') / (287.05 J/(kg K) "));
}

TEST_F(LesImport, ADensityJustOutOfRangeDiffersFromTheLimit) {
  CloudImportOptions options = with([](NetcdfBuilder& file) {
    file.variable("p", {"z"}, "Pa", profile(pressure));
    file.variable("T", {"z"}, "K", profile([](int k) { return kelvin(k) / 1.1004; }));
    file.text("T", "standard_name", "air_temperature");
  });
  EXPECT_THAT(error_of(options), AllOf(HasSubstr("found 1.100"), HasSubstr("allowed 0.9 to 1.1)")));
}

TEST_F(LesImport, PotentialTemperatureIsKnownByNameByAttributeAndByTheWeightOfTheAir) {
  const auto read = [&](const std::string& name, const std::string& meaning, const std::string& pressure_name) {
    return import_cloud(with([&](NetcdfBuilder& file) {
      file.variable(pressure_name, {"z"}, "Pa", profile(pressure));
      file.variable(name, {"z"}, "K", profile([](int) { return theta; }));
      file.text(name, "long_name", meaning);
    }));
  };
  expect_truth(read("th", "", "prs"));
  expect_truth(read("T", "potential temperature", "p"));
  const ImportedCloud by_weight = read("T", "temperature", "PABST");
  expect_truth(by_weight);
  EXPECT_THAT(notes_of(by_weight), HasSubstr("GUESSED: 'T' is the potential temperature (with it pressure"));
  // Temperature itself stays.
  const ImportedCloud cloud = import_cloud(with([&](NetcdfBuilder& file) {
    file.variable("p", {"z"}, "hPa", profile([](int k) { return pressure(k) / 100; }));
    file.variable("T", {"z"}, "K", profile(kelvin));
  }));
  expect_truth(cloud);
  EXPECT_THAT(notes_of(cloud), Not(HasSubstr("potential")));
}

/// The grid "temperature" by the closed form.
void expect_temperature(const ImportedCloud& cloud) {
  ASSERT_EQ(cloud.auxiliaries.size(), 1U);
  const VdbAuxiliary& found = cloud.auxiliaries[0];
  EXPECT_EQ(found.grid, "temperature");
  EXPECT_EQ(found.quantity, "temperature");
  EXPECT_EQ(found.units, "K");
  ASSERT_EQ(found.value.size(), cloud.field.value.size());
  // Powers of numbers of 32 bits.
  for (std::size_t n = 0; n < found.value.size(); ++n)
    EXPECT_NEAR(found.value[n], kelvin(3 + static_cast<int>(n) / (nx * ny)), 2e-4) << n;
}

TEST_F(LesImport, TemperatureBecomesAGridIfAskedFor) {
  const auto read = [&](const std::function<void(NetcdfBuilder&)>& add) {
    CloudImportOptions options = with(add);
    options.temperature_grid = true;
    return import_cloud(options);
  };
  const auto add_pressure = [](NetcdfBuilder& file) { file.variable("p", {"z"}, "Pa", profile(pressure)); };
  const auto add_density = [](NetcdfBuilder& file) { file.variable("rho", {"z"}, "kg/m3", profile(density)); };
  const auto add_theta = [](NetcdfBuilder& file) {
    file.variable("th", {"z"}, "K", profile([](int) { return theta; }));
  };
  // Temperature itself, with density by the gas law.
  const ImportedCloud cloud = read([&](NetcdfBuilder& file) {
    add_pressure(file);
    file.variable("T", {"z", "y", "x"}, "K", field([](int k, int, int) { return kelvin(k); }));
  });
  expect_truth(cloud);
  expect_temperature(cloud);
  EXPECT_THAT(notes_of(cloud), HasSubstr("temperature grid: 29"));
  // From the potential temperature, with density from the file or not.
  expect_temperature(read([&](NetcdfBuilder& file) {
    add_pressure(file);
    add_theta(file);
  }));
  expect_temperature(read([&](NetcdfBuilder& file) {
    add_pressure(file);
    add_theta(file);
    add_density(file);
  }));
  // In Celsius, without any pressure.
  expect_temperature(read([&](NetcdfBuilder& file) {
    add_density(file);
    file.variable("ta", {"z"}, "degC", profile([](int k) { return kelvin(k) - 273.15; }));
  }));
}

TEST_F(LesImport, LiquidWaterPotentialTemperatureLacksTheHeatOfCondensation) {
  // theta_l = theta - L q / (c_p exner): T is that of before, if c_p = 3.5 R and L = 2.5e6 J/kg.
  CloudImportOptions options = with([](NetcdfBuilder& file) {
    file.variable("p", {"z"}, "Pa", profile(pressure));
    file.variable("rho", {"z"}, "kg/m3", profile(density));
    file.variable("t", {"z", "y", "x"}, "K",
                  field([](int k, int j, int i) { return theta - 2.5e6 / heat_capacity * water(k, j, i) / exner(k); }));
    file.text("t", "long_name", "Liquid water potential temperature");
  });
  options.temperature_grid = true;
  expect_temperature(import_cloud(options));
}

TEST_F(LesImport, TemperatureThatIsNotThereIsAnError) {
  const auto error = [&](bool has_theta) {
    CloudImportOptions options = with([&](NetcdfBuilder& file) {
      file.variable("rho", {"z"}, "kg/m3", profile(density));
      if (has_theta) file.variable("th", {"z"}, "K", profile([](int) { return theta; }));
    });
    options.temperature_grid = true;
    return error_of(options);
  };
  EXPECT_THAT(error(false), HasSubstr("no temperature (found neither a temperature nor a potential one; fields in"));
  EXPECT_THAT(error(true), HasSubstr("'th' is the potential temperature (found no pressure beside it; fields in"));
}

TEST_F(LesImport, TemperatureThatRisesInTheCloudIsPotentialIfTheWeightTellsNothing) {
  const ImportedCloud cloud = import_cloud(with([&](NetcdfBuilder& file) {
    file.variable("p", {"z"}, "Pa", profile([](int) { return 9e4; }));
    file.variable("T", {"z"}, "K", profile([](int k) { return 300 + 0.2 * k; }));
  }));
  EXPECT_THAT(notes_of(cloud), HasSubstr("it rises from"));
  const double expected = 9e4 / (gas_constant * 300.6 * std::pow(0.9, 2.0 / 7));
  EXPECT_NEAR(cloud.field.value[0] / (1e3 * water(3, 0, 0) * expected), 1, 1e-5);
}

TEST_F(LesImport, TemperatureMayBeCelsiusIfTheUnitSaysSo) {
  const auto options = [&](const std::string& units) {
    return with([&](NetcdfBuilder& file) {
      file.variable("p", {"z"}, "Pa", profile(pressure));
      file.variable("ta", {"z"}, units, profile([](int k) { return kelvin(k) - 273.15; }));
    });
  };
  for (const char* units : {"degC", "degree_C", "Celsius", "degrees_Celsius", "C",
                            "\xc2\xb0"
                            "C"})
    expect_truth(import_cloud(options(units)));
  EXPECT_THAT(error_of(options("")), HasSubstr("'ta': cell (0, 0, 0) has the value"));
  EXPECT_THAT(error_of(options("")), HasSubstr("allowed 150 to 350 K"));
}

TEST_F(LesImport, PerturbationsAndOtherUnitsAreNoAir) {
  const auto air = [&](const std::string& name, const std::string& units, const std::vector<double>& value,
                       const std::string& meaning = "") {
    return with([&](NetcdfBuilder& file) {
      file.variable(name, {"z"}, units, value);
      file.text(name, "long_name", meaning);
      if (name != "rho") file.variable("T", {"z"}, "K", profile(kelvin));
    });
  };
  expect_truth(import_cloud(air("rho", "kg m^{-3}", profile(density))));
  EXPECT_THAT(error_of(air("p", "Pa", profile([](int k) { return 0.3 - 0.1 * k; }))),
              HasSubstr("has the value 0.3 Pa (allowed 100 to 120000 Pa) a perturbation"));
  EXPECT_THAT(error_of(air("p", "Pa", profile([](int) { return 500; }), "pressure perturbation")),
              HasSubstr("'p' is a perturbation of pressure by its attributes (found no base pressure"));
  EXPECT_THAT(error_of(air("rho", "kg/m3", profile([](int) { return 0.02; }), "density perturbation")),
              HasSubstr("perturbation of the air density"));
  EXPECT_THAT(error_of(air("rho", "", profile([](int k) { return 1e3 * density(k); }))),
              HasSubstr("(allowed 0.01 to 2 kg/m3)"));
  EXPECT_THAT(error_of(air("rho", "kg/m3", profile([](int k) { return density(nz - 1 - k); }))),
              HasSubstr("levels are upside down"));
  EXPECT_THAT(error_of(air("p", "Pa", profile([](int k) { return pressure(nz - 1 - k); }))),
              HasSubstr("levels are upside down"));
  // Pressure of levels that are 10 times as far apart.
  EXPECT_THAT(error_of(air("p", "Pa", profile([](int k) { return 95000 - 4000.0 * k; }))),
              HasSubstr("contradict each other"));
  // Numbers of air that a user names are checked too.
  CloudImportOptions options = air("rho", "kg/m3", profile(density));
  options.air_density = "12";
  EXPECT_THAT(error_of(options), HasSubstr("--air-density has the value 12 kg/m3 (allowed 0.01 to 2 kg/m3, a variable, "
                                           "or us-1976); air at the ground has about 1.2"));
}

TEST_F(LesImport, WithoutDensityTheMessageNamesWaysThatWork) {
  CloudImportOptions options = with([](NetcdfBuilder&) {});
  EXPECT_THAT(error_of(options), HasSubstr("name --air-density (a variable, a number in kg/m3, or us-1976)"));
  options.air_density = "1.1";
  EXPECT_NEAR(import_cloud(options).field.value[0], 1.1e3 * water(3, 0, 0), 1e-6);
  options.air_density = "us-1976";
  // U.S. Standard Atmosphere 1976, table I: 1.1673 kg/m3 at 500 m, 1.1560 at 600 m; 540 m between them.
  EXPECT_NEAR(import_cloud(options).field.value[0] / (1e3 * water(3, 0, 0)), 0.6 * 1.1673 + 0.4 * 1.1560, 2e-4);
}

}  // namespace
}  // namespace cloudbow
