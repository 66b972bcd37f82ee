// LES files in the layouts of models, and files that must not be mistaken for them. Truth: a cloud in an isentropic
// atmosphere, whose pressure, temperature and density are closed forms in balance with their heights.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "les_test_tools.hpp"

namespace cloudbow {
namespace {

using namespace les_test;
using testing::HasSubstr;
using testing::Not;

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
                                           "or us-1976) air at the ground has about 1.2"));
}

TEST_F(LesImport, AProfileIsNoCloudOfColumnsWithoutWidth) {
  CloudImportOptions options =
      with([](NetcdfBuilder& file) { file.variable("rho", {"z"}, "kg/m3", profile(density)); });
  options.variable = "rho";
  EXPECT_THAT(error_of(options), AllOf(HasSubstr("'rho' is a profile"), HasSubstr("no axis but z"),
                                       HasSubstr("--variable"), HasSubstr("--voxel-size-m")));
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

TEST_F(LesImport, HeightsOfIndexedLevelsComeFromTheFieldOfHeights) {
  const auto icon = [&](bool has_heights) {
    NetcdfBuilder file(folder_ / "icon.nc");
    file.dimension("height", nz);
    file.dimension("lat", ny);
    file.dimension("lon", nx);
    file.variable("height", {"height"}, "", profile([](int k) { return k + 1; }));
    file.variable("lat", {"lat"}, "degrees_north", {50, 50.001, 50.002});
    file.variable("lon", {"lon"}, "degrees_east", {8, 8.001});
    const std::vector<std::string> whole{"height", "lat", "lon"};
    file.variable("qc", whole, "kg kg-1", field([](int k, int j, int i) { return water(nz - 1 - k, j, i); }));
    file.variable("rho", whole, "kg m-3", field([](int k, int, int) { return density(nz - 1 - k); }));
    if (has_heights) {
      file.variable("z_mc", whole, "m", field([](int k, int, int) { return height(nz - 1 - k); }));
    }
    CloudImportOptions options;
    options.file = file.close();
    return options;
  };
  CloudImportOptions options = icon(true);
  options.voxel_size_m = {100, 100, 100};  // of columns: the file has levels
  const ImportedCloud cloud = import_cloud(options);
  expect_truth(cloud);
  EXPECT_NEAR(cloud.field.min_m[2], 400, 1e-9);
  options.voxel_size_m = {100, 100, 40};
  options.levels_by_voxel_size = true;  // the user's value is used, and the levels' order is that of the heights
  const ImportedCloud as_said = import_cloud(options);
  expect_truth(as_said);
  EXPECT_EQ(as_said.field.min_m[2], 0);
  EXPECT_THAT(notes_of(as_said), HasSubstr("in place of 'z_mc'"));

  options = icon(false);
  options.voxel_size_m = {100, 100, 40};
  EXPECT_THAT(error_of(options), HasSubstr("levels are upside down"));
}

TEST_F(LesImport, CoordinatesThatCountCellsAreNoLengths) {
  const auto counted = [&](const std::string& units, double first = 0) {
    NetcdfBuilder file(folder_ / "count.nc");
    file.dimension("z", nz);
    file.dimension("y", ny);
    file.dimension("x", nx);
    file.variable("z", {"z"}, units, profile([first](int k) { return first + k; }));
    file.variable("y", {"y"}, units, {first, first + 1, first + 2});
    file.variable("x", {"x"}, units, {first, first + 1});
    add_water(file, "lwc", "g m-3", 1000);
    CloudImportOptions options;
    options.file = file.close();
    return options;
  };
  EXPECT_THAT(error_of(counted("m")), HasSubstr("coordinates count cells"));
  EXPECT_THAT(error_of(counted("")), HasSubstr("'x' has no unit and counts cells: 0, 1, ..."));
  EXPECT_THAT(error_of(counted("", 0.5)), HasSubstr("'x' has no unit and counts cells: 0.5, 1.5, ..."));
  EXPECT_EQ(import_cloud(counted("m", 0.5)).field.cell_size_m, (std::array<double, 3>{1, 1, 1}));
  for (const char* units : {"m", "", "1", "level"}) {
    CloudImportOptions options = counted(units);
    options.voxel_size_m = {100, 100, 40};
    options.levels_by_voxel_size = true;
    const ImportedCloud cloud = import_cloud(options);
    EXPECT_EQ(cloud.field.cell_size_m, (std::array<double, 3>{100, 100, 40}));
    EXPECT_THAT(notes_of(cloud), HasSubstr("levels: 10 of 40 m from the ground"));
  }
}

TEST_F(LesImport, EdgesComeFromBoundsOfTheCoordinate) {
  // Levels of 20 and 60 m in turn: centres alone would put the edges elsewhere.
  const auto edge = [](int k) { return 40.0 * k + (k % 2 == 1 ? -20 : 0); };
  for (const bool descend : {false, true}) {
    NetcdfBuilder file(folder_ / "bounds.nc");
    file.dimension("z", nz);
    file.dimension("y", ny);
    file.dimension("x", nx);
    file.dimension("two", 2);
    std::vector<double> centre, bounds;
    for (int n = 0; n < nz; ++n) {
      const int k = descend ? nz - 1 - n : n;
      centre.push_back(0.5 * (edge(k) + edge(k + 1)));
      bounds.insert(bounds.end(), {edge(k), edge(k + 1)});
    }
    file.variable("z", {"z"}, "m", centre);
    file.text("z", "bounds", "z_bnds");
    file.variable("z_bnds", {"z", "two"}, "", bounds);
    file.variable("y", {"y"}, "m", {50, 150, 250});
    file.variable("x", {"x"}, "m", {50, 150});
    file.variable("lwc", {"z", "y", "x"}, "g m-3", field([&](int n, int, int) {
                    const int k = descend ? nz - 1 - n : n;
                    return k == 4 || k == 5 ? 0.1 * (k - 3) : 0.0;
                  }));
    CloudImportOptions options;
    options.file = file.close();
    const CloudField found = import_cloud(options).field;
    EXPECT_NEAR(column_integrals(found)[0], 0.1 * 20 + 0.2 * 60, 1e-5);
    EXPECT_NEAR(found.cell_size_m[2], 20, 1e-9);
  }
}

TEST_F(LesImport, HeightsInKilometresOf32BitsGiveTheSameVoxelsAsMetres) {
  const auto read = [&](const std::string& units, double unit, nc_type type) {
    NetcdfBuilder file(folder_ / "km.nc");
    file.dimension("z", nz);
    file.dimension("y", ny);
    file.dimension("x", nx);
    file.variable("z", {"z"}, units, profile([&](int k) { return height(k) * unit; }), type);
    file.variable("y", {"y"}, "km", {0.05, 0.15, 0.25});
    file.variable("x", {"x"}, "km", {0.05, 0.15});
    add_water(file, "lwc", "g m-3", 1000);
    CloudImportOptions options;
    options.file = file.close();
    return import_cloud(options).field;
  };
  const CloudField metres = read("m", 1, NC_FLOAT);
  EXPECT_EQ(metres.active_voxels(), std::size_t{4 * nx * ny});
  for (const nc_type type : {NC_FLOAT, NC_DOUBLE}) {
    const CloudField kilometres = read("km", 1e-3, type);
    EXPECT_EQ(kilometres.active_voxels(), metres.active_voxels());
    EXPECT_NEAR(kilometres.cell_size_m[2], 40, 1e-9);
    EXPECT_EQ(kilometres.value, metres.value);
  }
}

TEST_F(LesImport, ColumnsThatDescendAreTurnedRound) {
  NetcdfBuilder file(folder_ / "turned.nc");
  file.dimension("z", nz);
  file.dimension("y", ny);
  file.dimension("x", nx);
  file.variable("z", {"z"}, "m", profile(height));
  file.variable("y", {"y"}, "m", {250, 150, 50});
  file.variable("x", {"x"}, "m", {150, 50});
  file.variable("rho", {"z"}, "kg/m3", profile(density));
  file.variable("qc", {"z", "y", "x"}, "kg/kg",
                field([](int k, int j, int i) { return water(k, ny - 1 - j, nx - 1 - i); }));
  CloudImportOptions options;
  options.file = file.close();
  const ImportedCloud cloud = import_cloud(options);
  expect_truth(cloud);
  EXPECT_EQ(cloud.field.min_m[0], 0);
  EXPECT_EQ(cloud.field.min_m[1], 0);
}

TEST_F(LesImport, MissingValuesAreKnownInAllTheirForms) {
  const auto file_with = [&](const std::function<void(NetcdfBuilder&)>& say, double missing = 1e20) {
    return with(
        [&](NetcdfBuilder& file) {
          file.variable("qc", {"z", "y", "x"}, "g/kg", field([missing](int k, int j, int i) {
                          return k == 4 && j == 1 && i == 1 ? missing : 1e3 * water(k, j, i);
                        }));
          file.variable("rho", {"z"}, "kg/m3", profile(density));
          say(file);
        },
        false);
  };
  const std::vector<std::function<void(NetcdfBuilder&)>> ways{
      [](NetcdfBuilder& file) { file.number("qc", "missing_value", {1e20}, NC_FLOAT); },
      [](NetcdfBuilder& file) { file.number("qc", "missing_value", {1e20}, NC_DOUBLE); },
      [](NetcdfBuilder& file) {
        file.number("qc", "missing_value", {-999, 1e20}, NC_DOUBLE);
      },
      [](NetcdfBuilder& file) { file.text("qc", "missing_value", "1e20"); },
      [](NetcdfBuilder& file) {
        file.number("qc", "valid_range", {0, 50}, NC_FLOAT);
      },
      [](NetcdfBuilder& file) { file.number("qc", "valid_max", {50}, NC_FLOAT); }};
  for (const auto& way : ways) {
    CloudImportOptions options = file_with(way);
    EXPECT_THAT(error_of(options), HasSubstr("'qc': cell (1, 1, 4) has the value NaN or missing"));
    options.fill = "clear";
    const ImportedCloud cloud = import_cloud(options);
    EXPECT_EQ(cloud.field.active_voxels(), std::size_t{4 * nx * ny - 1});
    EXPECT_THAT(notes_of(cloud), HasSubstr("1 cells are missing and count as clear air"));
  }
  EXPECT_THAT(error_of(file_with([](NetcdfBuilder& file) { file.number("qc", "valid_min", {0}, NC_FLOAT); }, -9999)),
              HasSubstr("NaN or missing"));
  // Said in no way it is no water that there is.
  EXPECT_THAT(error_of(file_with([](NetcdfBuilder&) {})), HasSubstr("allowed up to 20 g/m3"));
  // Attributes that cannot be followed are not passed over.
  EXPECT_THAT(error_of(file_with([](NetcdfBuilder& file) { file.text("qc", "scale_factor", "a tenth"); })),
              HasSubstr("attribute scale_factor is not a number (found 'a tenth')"));
  EXPECT_THAT(error_of(file_with([](NetcdfBuilder& file) {
                file.number("qc", "scale_factor", {1, 2}, NC_DOUBLE);
              })),
              HasSubstr("attribute scale_factor is not one number (found 2)"));
  EXPECT_THAT(error_of(file_with([](NetcdfBuilder& file) { file.number("qc", "valid_range", {1}, NC_DOUBLE); })),
              HasSubstr("valid_range is not two numbers"));
}

TEST_F(LesImport, PackedNumbersAreValidByWhatIsStoredAndZeroToTheStep) {
  constexpr double step = 1e-7;
  double offset = 9.9997e-4;  // 0 lies between two steps, and the lower one is nearer
  const auto packed = [&](double extra, const std::function<void(NetcdfBuilder&)>& say) {
    return with(
        [&](NetcdfBuilder& file) {
          file.variable("qc", {"z", "y", "x"}, "kg kg**-1", field([&](int k, int j, int i) {
                          const double value = water(k, j, i) + (k == 4 && j == 0 && i == 0 ? extra : 0);
                          return std::floor((value - offset) / step + 0.4);
                        }),
                        NC_SHORT);
          file.number("qc", "scale_factor", {step}, NC_DOUBLE);
          file.number("qc", "add_offset", {offset}, NC_DOUBLE);
          file.variable("rho", {"z"}, "kg/m3", profile(density));
          say(file);
        },
        false);
  };
  const ImportedCloud cloud = import_cloud(packed(0, [](NetcdfBuilder&) {}));
  expect_truth(cloud, 1, 1e-3);  // a step is that much of 4e-4 kg/kg, the least water
  EXPECT_THAT(notes_of(cloud), HasSubstr("36 cells barely below 0 count as 0"));
  offset = 1.00003e-3;  // the upper one is nearer: no haze of 0.3 steps
  const ImportedCloud above = import_cloud(packed(0, [](NetcdfBuilder&) {}));
  expect_truth(above, 1, 1e-3);
  EXPECT_THAT(notes_of(above), HasSubstr("36 cells within half a step of its packing"));
  // 1.2e-3 kg/kg is stored as 2000: a range of integers is of stored numbers, one of floats of unpacked ones.
  const auto range = [](double most, nc_type type) {
    return [most, type](NetcdfBuilder& file) { file.number("qc", "valid_max", {most}, type); };
  };
  EXPECT_THAT(error_of(packed(7e-4, range(1000, NC_SHORT))), HasSubstr("cell (0, 0, 4) has the value NaN or missing"));
  EXPECT_THAT(error_of(packed(7e-4, range(1.1e-3, NC_DOUBLE))), HasSubstr("cell (0, 0, 4) has the value NaN"));
  EXPECT_EQ(import_cloud(packed(7e-4, range(1.3e-3, NC_DOUBLE))).field.active_voxels(), std::size_t{4 * nx * ny});
  // More than a step below 0 is an error.
  EXPECT_THAT(error_of(packed(-1e-3, [](NetcdfBuilder&) {})), HasSubstr("allowed: numbers >= 0, and down to"));
}

TEST_F(LesImport, OtherSpeciesAreToldAndNeverMixed) {
  const auto add_rho = [](NetcdfBuilder& file) { file.variable("rho", {"z"}, "kg/m3", profile(density)); };
  const ImportedCloud cloud = import_cloud(with([&](NetcdfBuilder& file) {
    add_rho(file);
    add_water(file, "qi", "kg/kg", 0.3);
    add_water(file, "qr", "kg/kg", 0.5);
    add_water(file, "qg", "kg/kg", 0);
  }));
  expect_truth(cloud);
  EXPECT_THAT(notes_of(cloud), HasSubstr("NOT imported: 'qi', cloud ice"));
  EXPECT_THAT(notes_of(cloud), HasSubstr("NOT imported: 'qr', rain"));
  EXPECT_THAT(notes_of(cloud), Not(HasSubstr("'qg'")));  // nothing there
  EXPECT_THAT(notes_of(cloud), Not(HasSubstr("counts as liquid water")));
  CloudImportOptions ice = with([&](NetcdfBuilder& file) {
    add_rho(file);
    add_water(file, "qi", "kg/kg", 0.3);
  });
  ice.variable = "qi";
  EXPECT_THAT(notes_of(import_cloud(ice)), HasSubstr("'qi' is cloud ice by its name, and counts as liquid water"));

  const auto two = with([&](NetcdfBuilder& file) {
    add_rho(file);
    add_water(file, "ql", "kg/kg", 1.5);
  });
  EXPECT_THAT(error_of(two), HasSubstr("two kinds of liquid water (found 'qc' and 'ql', which differ"));
  CloudImportOptions chosen = two;
  chosen.variable = "ql";
  expect_truth(import_cloud(chosen), 1.5);
  expect_truth(import_cloud(with([&](NetcdfBuilder& file) {  // the same twice
    add_rho(file);
    add_water(file, "ql");
  })));
}

TEST_F(LesImport, WaterAndIceTogetherAreWaterLessIce) {
  const auto sam = [&](bool has_ice, double coldest) {
    return with(
        [&](NetcdfBuilder& file) {
          file.variable("RHO", {"z"}, "kg/m3", profile(density));
          add_water(file, "QN", "g/kg", 1000);
          if (has_ice) add_water(file, "QI", "g/kg", 900);
          file.variable("TABS", {"z"}, "K", profile([coldest](int) { return coldest; }));
        },
        false);
  };
  expect_truth(import_cloud(sam(true, 260)), 0.1, 1e-4);  // a difference of numbers ten times as large
  const ImportedCloud warm = import_cloud(sam(false, 280));
  expect_truth(warm);
  EXPECT_THAT(notes_of(warm), HasSubstr("'QN' is water and ice together, all of it counts as liquid"));
  EXPECT_THAT(error_of(sam(false, 260)), HasSubstr("may hold ice (found 260 K"));
}

TEST_F(LesImport, ExtinctionIsReadInItsUnit) {
  const auto extinction = [&](const std::string& units, double factor) {
    return with(
        [&](NetcdfBuilder& file) {
          add_water(file, "extinction", units, factor);
          file.variable("ssa", {"z"}, "1", profile([](int k) { return 0.9 + 0.01 * k; }));
          file.variable("reff", {"z"}, "Micron", profile([](int) { return 10; }));
        },
        false);
  };
  for (const auto& [units, factor] : {std::pair{"m-1", 1.0}, {"1/km", 1e3}, {"km^-1", 1e3}}) {
    const ImportedCloud cloud = import_cloud(extinction(units, factor));
    EXPECT_EQ(cloud.field.quantity, "extinction");
    ASSERT_EQ(cloud.auxiliaries.size(), 2U);
    EXPECT_NEAR(cloud.field.value[0] / water(3, 0, 0), 1, 1e-6);
    EXPECT_NEAR(cloud.auxiliaries[0].value[0], 10, 1e-6);
    EXPECT_NEAR(cloud.auxiliaries[1].value[0], 0.93, 1e-6);
  }
  EXPECT_THAT(error_of(extinction("", 1)), HasSubstr("unit of extinction not known"));
  EXPECT_THAT(error_of(extinction("m-1", 1e6)), HasSubstr("(allowed up to 10 1/m)"));
  CloudImportOptions options = with([&](NetcdfBuilder& file) {
    file.variable("rho", {"z"}, "kg/m3", profile(density));
    add_water(file, "ext", "1/m", 2);
  });
  const ImportedCloud both = import_cloud(options);
  expect_truth(both);
  EXPECT_THAT(notes_of(both), HasSubstr("NOT imported: 'ext', extinction"));
  options.quantity = "extinction";
  EXPECT_NEAR(import_cloud(options).field.value[0] / water(3, 0, 0), 2, 1e-6);
}

TEST_F(LesImport, UnitsAreReadInAllSpellingsAndMegaIsNotMilli) {
  const auto read = [&](const std::string& units, double factor) {
    return with(
        [&](NetcdfBuilder& file) {
          add_water(file, "qc", units, factor);
          file.variable("rho", {"z"}, "KG/M^3", profile(density));
        },
        false);
  };
  for (const char* units : {"KG/KG", "Kg/Kg", "kg kg^{-1}", "kg kg**-1", "[kg/kg]", "kg kg\xe2\x81\xbb\xc2\xb9"})
    expect_truth(import_cloud(read(units, 1)));
  for (const char* units : {"1e-5kg/kg", "1.e-5 kg kg-1", "1E-2 g/kg"}) expect_truth(import_cloud(read(units, 1e5)));
  expect_truth(import_cloud(read("mg/kg", 1e6)));
  for (const char* units : {"MG/KG", "Mg/kg", "10-3 kg/kg", "kg", "K"})
    EXPECT_THAT(error_of(read(units, 1)), HasSubstr("unit not known")) << units;
}

TEST_F(LesImport, NumbersThatNoCloudHasAreRefused) {
  const auto add_rho = [](NetcdfBuilder& file) { file.variable("rho", {"z"}, "kg/m3", profile(density)); };
  CloudImportOptions options = with(add_rho);
  options.units = "g/m3";
  options.variable = "qc";
  EXPECT_GT(import_cloud(options).field.active_voxels(), 0U);
  options.units = "1e5 g/m3";
  EXPECT_THAT(error_of(options), HasSubstr("'qc' [1e5 g/m3]: cell (0, 0, 3) holds"));
  EXPECT_THAT(error_of(options), HasSubstr("(allowed up to 20 g/m3)"));

  options = with(add_rho);
  options.voxel_size_m = {100, 100, 6000};
  options.levels_by_voxel_size = true;
  EXPECT_THAT(error_of(options), HasSubstr("level 0 is 6000 m thick, from 0 to 6000 m (allowed 0.001 to 5000 m)"));

  const auto with_variable = [&](const std::string& name, const std::string& units, double value) {
    return with([&](NetcdfBuilder& file) {
      add_rho(file);
      file.variable(name, {"z"}, units, profile([value](int) { return value; }));
    });
  };
  EXPECT_THAT(error_of(with_variable("reff", "um", 1e-5)), HasSubstr("(allowed 0.1 to 5000 um)"));
  EXPECT_THAT(error_of(with_variable("NC", "cm-3", 1e8)), HasSubstr("droplet number 'NC'"));
  EXPECT_THAT(error_of(with_variable("NC", "m-3", 100)), HasSubstr("(allowed 0.1 to 100000 per cm3)"));

  NetcdfBuilder file(folder_ / "below.nc");
  file.dimension("z", nz);
  file.variable("z", {"z"}, "m", profile([](int k) { return height(k) - 800; }));
  file.variable("lwc", {"z"}, "g/m3", profile([](int k) { return k == 3 ? 0.1 : 0.0; }));
  options = {};
  options.file = file.close();
  options.voxel_size_m = {100, 100, 100};
  EXPECT_THAT(error_of(options), HasSubstr("cloud below the ground (found it at -260 m"));
}

TEST_F(LesImport, ALockedFileSaysSo) {
  const CloudImportOptions options = with([](NetcdfBuilder&) {});
  const int writer = open(options.file.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(flock(writer, LOCK_EX), 0);
  EXPECT_THAT(error_of(options), HasSubstr("is locked"));
  close(writer);
  EXPECT_THAT(error_of(options), HasSubstr("air's density"));
}

}  // namespace
}  // namespace cloudbow
