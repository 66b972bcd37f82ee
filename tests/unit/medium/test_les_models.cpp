// Layouts of models, levels that follow the terrain, air from other files, several species, series. Truth: sums by hand
// over the numbers that the files are made of, and closed forms of the isentropic atmosphere.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "les_test_tools.hpp"

namespace cloudbow {
namespace {

using namespace les_test;
using testing::HasSubstr;
using testing::Not;

/// Water path of each column [g/m2] of a field on uniform voxels.
std::vector<double> paths(const CloudField& field) { return column_depths(field); }

/// As numbers of 32 bits are in a file.
double stored(double value) { return static_cast<double>(static_cast<float>(value)); }

constexpr int columns = nx * ny;

/// Edges of levels over a hill, of thickness that differs from column to column.
double terrain_edge(int k, int j, int i) { return 35.0 * i + 10.0 * j + k * (40 + 1.7 * j - 0.6 * i) + 0.2 * k * k; }

void expect_paths(const ImportedCloud& cloud, const std::vector<double>& wanted, double tolerance = 1e-6) {
  const std::vector<double> found = paths(cloud.field);
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t c = 0; c < found.size(); ++c) EXPECT_NEAR(found[c] / wanted[c], 1, tolerance) << c;
}

// -- levels over terrain ----------------------------------------------------------------------------------------------

class Terrain : public LesImport {
 protected:
  /// Water of the base case [g/m3] on the levels of the hill. Heights are those of edges or of centres.
  CloudImportOptions over_hill(bool from_top, bool at_edges, const std::string& units = "m", double unit = 1) const {
    NetcdfBuilder file(folder_ / "hill.nc");
    file.dimension("level", nz);
    file.dimension("level1", nz + 1);
    file.dimension("y", ny);
    file.dimension("x", nx);
    file.variable("y", {"y"}, "m", {50, 150, 250});
    file.variable("x", {"x"}, "m", {50, 150});
    const auto level = [from_top](int k, int count) { return from_top ? count - 1 - k : k; };
    file.variable("lwc", {"level", "y", "x"}, "g/m3",
                  field([&](int k, int j, int i) { return 1e3 * water(level(k, nz), j, i); }));
    const auto edge = [unit](int k, int j, int i) { return unit * terrain_edge(k, j, i); };
    if (at_edges) {
      file.variable("HHL", {"level1", "y", "x"}, units,
                    field([&](int k, int j, int i) { return edge(level(k, nz + 1), j, i); }, nz + 1), NC_DOUBLE);
    } else {
      file.variable("z_mc", {"level", "y", "x"}, units, field([&](int k, int j, int i) {
                      const int n = level(k, nz);
                      return 0.5 * (edge(n, j, i) + edge(n + 1, j, i));
                    }),
                    NC_DOUBLE);
    }
    CloudImportOptions options;
    options.file = file.close();
    return options;
  }
  static std::vector<double> paths_over_hill() {
    std::vector<double> path;
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        path.push_back(0);
        for (int k = 0; k < nz; ++k)
          path.back() += stored(1e3 * water(k, j, i)) * (terrain_edge(k + 1, j, i) - terrain_edge(k, j, i));
      }
    }
    return path;
  }
  /// Of levels that meet halfway between the centres.
  static std::vector<double> paths_between_centres() {
    std::vector<double> wanted;
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        const auto centre = [&](int k) { return 0.5 * (terrain_edge(k, j, i) + terrain_edge(k + 1, j, i)); };
        wanted.push_back(0);
        for (int k = 3; k <= 6; ++k)
          wanted.back() += stored(1e3 * water(k, j, i)) * 0.5 * (centre(k + 1) - centre(k - 1));
      }
    }
    return wanted;
  }
};

TEST_F(Terrain, EveryColumnKeepsItsWaterWhateverTheVoxels) {
  for (const bool from_top : {false, true}) {
    CloudImportOptions options = over_hill(from_top, true);
    for (const double size : {0.0, 7.3, 40.0, 61.0}) {
      options.vertical_size_m = size;
      const ImportedCloud cloud = import_cloud(options);
      expect_paths(cloud, paths_over_hill());
      EXPECT_NEAR(cloud.field.min_m[2], 0, 1e-9);
      EXPECT_THAT(notes_of(cloud),
                  HasSubstr("heights differ from column to column, the lowest edge lies at 0 to 55 m"));
      EXPECT_THAT(notes_of(cloud), HasSubstr("column by column; voxels below the terrain are clear"));
    }
  }
  // Geopotential instead of heights.
  expect_paths(import_cloud(over_hill(true, true, "m**2 s**-2", 9.80665)), paths_over_hill());
}

TEST_F(Terrain, AVoxelIsTheMeanOfTheLevelsInIt) {
  CloudImportOptions options = over_hill(false, true);
  options.vertical_size_m = 25;
  const CloudField field = import_cloud(options).field;
  const std::vector<float> dense = to_dense(field);
  const double size = field.cell_size_m[2];
  for (int k = 0; k < field.cells[2]; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        double mean = 0;
        for (int n = 0; n < nz; ++n) {
          const double low = std::max(k * size, terrain_edge(n, j, i));
          const double high = std::min((k + 1) * size, terrain_edge(n + 1, j, i));
          mean += stored(1e3 * water(n, j, i)) * std::max(0.0, high - low) / size;
        }
        EXPECT_NEAR(dense[static_cast<std::size_t>((k * ny + j) * nx + i)], mean, 1e-6);
      }
    }
  }
}

TEST_F(Terrain, CentresMeetHalfwayInEveryColumn) {
  expect_paths(import_cloud(over_hill(true, false)), paths_between_centres());
}

TEST_F(Terrain, HeightsOfCellsHoldOverThoseOfTheCoordinate) {
  const auto meso_nh = [&](bool has_heights) {
    NetcdfBuilder file(folder_ / "mesonh.nc");
    file.dimension("level", nz);
    file.dimension("nj", ny);
    file.dimension("ni", nx);
    file.variable("level", {"level"}, "m", profile(height));
    file.variable("nj", {"nj"}, "m", {50, 150, 250});
    file.variable("ni", {"ni"}, "m", {50, 150});
    file.variable("ZS", {"nj", "ni"}, "m", {0, 35, 10, 45, 20, 55});
    const std::vector<std::string> whole{"level", "nj", "ni"};
    file.variable("RCT", whole, "g/m3", field([](int k, int j, int i) { return 1e3 * water(k, j, i); }));
    file.variable("THT", {"level"}, "K", profile([](int) { return theta; }));
    if (has_heights) {
      file.variable("ALT", whole, "m", field([](int k, int j, int i) {
                      return 0.5 * (terrain_edge(k, j, i) + terrain_edge(k + 1, j, i));
                    }),
                    NC_DOUBLE);
    }
    CloudImportOptions options;
    options.file = file.close();
    return import_cloud(options);
  };
  EXPECT_THAT(notes_of(meso_nh(false)),
              HasSubstr("CHECK the heights: the ground 'ZS' reaches from 0 to 55, the levels"));
  const ImportedCloud cloud = meso_nh(true);
  EXPECT_THAT(notes_of(cloud), Not(HasSubstr("CHECK")));
  expect_paths(cloud, paths_between_centres());
}

TEST_F(Terrain, LevelsOfAColumnThatCrossAreRefused) {
  NetcdfBuilder file(folder_ / "crossed.nc");
  file.dimension("level", nz);
  file.dimension("y", ny);
  file.dimension("x", nx);
  file.variable("y", {"y"}, "m", {50, 150, 250});
  file.variable("x", {"x"}, "m", {50, 150});
  file.variable("lwc", {"level", "y", "x"}, "g/m3", field([](int k, int j, int i) { return 1e3 * water(k, j, i); }));
  file.variable("z_mc", {"level", "y", "x"}, "m",
                field([](int k, int j, int i) { return height(k) + (k == 5 && j == 1 && i == 1 ? -60 : 0); }));
  CloudImportOptions options;
  options.file = file.close();
  EXPECT_THAT(error_of(options), HasSubstr("'z_mc': levels of column (1, 1) are not monotonic"));
}

// -- layouts ----------------------------------------------------------------------------------------------------------

TEST_F(LesImport, ModelsAreRecognisedAndTheNoteSaysBy) {
  const auto note = [&](const std::function<void(NetcdfBuilder&)>& add, bool has_water = false) {
    CloudImportOptions options = with(
        [&](NetcdfBuilder& file) {
          file.variable("rho", {"z"}, "kg/m3", profile(density));
          add(file);
        },
        has_water);
    return notes_of(import_cloud(options));
  };
  const auto named = [&](const std::string& liquid, const std::vector<std::string>& others) {
    return note([&](NetcdfBuilder& file) {
      add_water(file, liquid);
      for (const std::string& other : others) file.variable(other, {"z"}, "", profile([](int) { return 1.1; }));
    });
  };
  EXPECT_THAT(named("RCP", {}), HasSubstr("model: RAMS (by the names 'RCP')"));
  EXPECT_THAT(named("clwc", {}), HasSubstr("model: ERA5 (by the names 'clwc')"));
  EXPECT_THAT(named("RCT", {"THT"}), HasSubstr("model: Meso-NH (by the names 'RCT', 'THT')"));
  EXPECT_THAT(named("q_cloud_liquid_mass", {}), HasSubstr("model: MONC (by"));
  EXPECT_THAT(named("qc", {"prs", "th"}), HasSubstr("model: CM1 (by the names 'prs', 'th')"));
  EXPECT_THAT(named("l", {"dn0"}), HasSubstr("model: UCLALES (by the names 'l', 'dn0')"));
  EXPECT_THAT(named("ql", {"thl", "rhobf"}), HasSubstr("model: DALES (by the names 'ql', 'rhobf')"));
  EXPECT_THAT(named("ql", {"phydro"}), HasSubstr("model: MicroHH (by the names 'phydro', 'ql')"));
  EXPECT_THAT(named("QC", {"TABS"}), HasSubstr("model: SAM (by the names 'QC', 'TABS')"));
  const std::string by_title = note([](NetcdfBuilder& file) { file.text("", "title", "PALM 23.10"); }, true);
  EXPECT_THAT(by_title, HasSubstr("model: PALM (the file's attribute title says so)"));
  EXPECT_THAT(note([](NetcdfBuilder& file) { file.text("", "source", "a sample of napalm"); }, true),
              Not(HasSubstr("model:")));
  EXPECT_THAT(note([](NetcdfBuilder&) {}, true), Not(HasSubstr("model:")));
}

TEST_F(LesImport, TheModelMayBeSaid) {
  CloudImportOptions options = with([](NetcdfBuilder& file) {
    file.variable("rho", {"z"}, "kg/m3", profile(density));
    file.variable("p", {"z"}, "Pa", profile([](int) { return 0.3; }));
  });
  options.model = "cm1";
  EXPECT_THAT(notes_of(import_cloud(options)), HasSubstr("model: CM1 (as --model says)"));
  options.model = "rams";
  EXPECT_THAT(error_of(options), AllOf(HasSubstr("no water of the model that --model names, RAMS (found none of RCP"),
                                       HasSubstr("--variable")));
  options.variable = "qc";
  expect_truth(import_cloud(options));
  options.model = "mm5";
  EXPECT_THAT(error_of(options), HasSubstr("--model: unknown (found \"mm5\", allowed auto, cm1"));
}

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

TEST_F(LesImport, DegreesBecomeMetres) {
  constexpr double step = 0.001, latitude = 50, metre = 6371229 * std::numbers::pi / 180;
  const auto globe = [&](double step_y) {
    NetcdfBuilder file(folder_ / "globe.nc");
    file.dimension("z", nz);
    file.dimension("lat", ny);
    file.dimension("lon", nx);
    file.variable("z", {"z"}, "m", profile(height));
    file.variable("lat", {"lat"}, "degrees_north", {latitude + step_y, latitude, latitude - step_y});
    file.variable("lon", {"lon"}, "degrees_east", {8, 8 + step});
    file.variable("qc", {"z", "lat", "lon"}, "kg/kg",
                  field([](int k, int j, int i) { return water(k, ny - 1 - j, i); }));
    file.variable("rho", {"z"}, "kg/m3", profile(density));
    CloudImportOptions options;
    options.file = file.close();
    return options;
  };
  const ImportedCloud cloud = import_cloud(globe(step));
  EXPECT_NEAR(cloud.field.cell_size_m[0] / (step * metre * std::cos(latitude * std::numbers::pi / 180)), 1, 2e-3);
  EXPECT_NEAR(cloud.field.cell_size_m[1] / (step * metre), 1, 2e-3);                 // numbers of 32 bits
  EXPECT_NEAR(cloud.field.value[0] / (1e3 * water(3, 0, 0) * density(3)), 1, 1e-5);  // from south to north
  EXPECT_THAT(notes_of(cloud), HasSubstr("in degrees at the mean latitude 50"));
  EXPECT_THAT(error_of(globe(2)),
              AllOf(HasSubstr("columns differ in width by more than 0.02"), HasSubstr("--voxel-size-m")));
}

TEST_F(LesImport, LevelsOfPressureAndGeopotentialAreRead) {
  // As reanalyses have them: from the top, pressure as the coordinate, heights as a geopotential, packed water.
  constexpr double step = 2e-8;
  NetcdfBuilder file(folder_ / "levels.nc");
  file.dimension("time", 1);
  file.dimension("level", nz);
  file.dimension("latitude", ny);
  file.dimension("longitude", nx);
  const auto up = [](int k) { return nz - 1 - k; };
  file.variable("level", {"level"}, "millibars", profile([&](int k) { return pressure(up(k)) / 100; }), NC_DOUBLE);
  file.variable("latitude", {"latitude"}, "degrees_north", {50.25, 50, 49.75}, NC_DOUBLE);
  file.variable("longitude", {"longitude"}, "degrees_east", {8, 8.25}, NC_DOUBLE);
  const std::vector<std::string> whole{"time", "level", "latitude", "longitude"};
  file.variable("clwc", whole, "kg kg**-1",
                field([&](int k, int j, int i) { return std::round(water(up(k), ny - 1 - j, i) / step); }), NC_INT);
  file.number("clwc", "scale_factor", {step}, NC_DOUBLE);
  file.variable("t", whole, "K", field([&](int k, int, int) { return kelvin(up(k)); }));
  file.variable("z", whole, "m**2 s**-2", field([&](int k, int, int) { return 9.80665 * height(up(k)); }), NC_DOUBLE);
  CloudImportOptions options;
  options.file = file.close();
  const ImportedCloud cloud = import_cloud(options);
  EXPECT_THAT(notes_of(cloud), AllOf(HasSubstr("model: ERA5"), HasSubstr("'z' is the geopotential")));
  ASSERT_EQ(cloud.field.value.size(), std::size_t{4 * columns});
  EXPECT_NEAR(cloud.field.value[0] / (1e3 * water(3, 0, 0) * density(3)), 1, 5e-5);  // a step of the packing
  EXPECT_NEAR(cloud.field.cell_size_m[2], 40, 1e-3);
}

TEST_F(LesImport, FilesOfOtherKindsSayWhatToDo) {
  CloudImportOptions options = with([](NetcdfBuilder& file) { add_water(file, "qi"); }, false);
  EXPECT_THAT(error_of(options), HasSubstr("or give --species ice for its cloud ice"));
  options.file = folder_ / "a.grib";
  std::ofstream(options.file) << "GRIB and more";
  EXPECT_THAT(error_of(options), HasSubstr("convert it first"));
}

TEST_F(LesImport, VariablesOfGroupsAreRead) {
  const CloudImportOptions options = with([](NetcdfBuilder& file) {
    file.group("air");
    file.variable("rho", {"z"}, "kg/m3", profile(density));
    file.variable("qc", {"z"}, "kg/kg", profile([](int) { return 7; }));  // the file's own counts
  });
  expect_truth(import_cloud(options));
}

TEST_F(LesImport, UnstructuredGridsAreRefusedWithTheWayOut) {
  NetcdfBuilder file(folder_ / "cells.nc");
  file.dimension("height", nz);
  file.dimension("ncells", columns);
  file.variable("qc", {"height", "ncells"}, "kg/kg", field(water));
  CloudImportOptions options;
  options.file = file.close();
  EXPECT_THAT(error_of(options), HasSubstr("'ncells' counts the cells of an unstructured grid"));
}

// -- air from other files ---------------------------------------------------------------------------------------------

class AirFiles : public LesImport {
 protected:
  std::filesystem::path text(const std::string& content) const {
    const auto path = folder_ / "profile.txt";
    std::ofstream(path) << content;
    return path;
  }
  /// Density e^(-z/8 km), whose logarithm is linear.
  static double thin(double z) { return 1.2 * std::exp(-z / 8000); }
};

TEST_F(AirFiles, ADensityByHeightIsInterpolatedByItsLogarithm) {
  CloudImportOptions options = with([](NetcdfBuilder&) {});
  std::string lines = "# height(km) other rho(g/m3)\n";
  for (const double km : {3.0, 1.0, 0.0}) lines += fmt::format("{} 7 {:.10g}\n", km, 1e3 * thin(1000 * km));
  options.profile = text(lines);
  const auto expect = [&](const ImportedCloud& cloud) {
    for (int k = 3; k <= 6; ++k)
      EXPECT_NEAR(
          cloud.field.value[static_cast<std::size_t>((k - 3) * columns)] / (1e3 * water(k, 0, 0) * thin(height(k))), 1,
          1e-6);
  };
  const ImportedCloud cloud = import_cloud(options);
  expect(cloud);
  EXPECT_THAT(notes_of(cloud), HasSubstr("profile.txt at the heights of the cells"));

  NetcdfBuilder file(folder_ / "profile.nc");
  file.dimension("time", 2);
  file.dimension("zh", 3);
  file.variable("zh", {"zh"}, "m", {0, 1000, 3000}, NC_DOUBLE);
  file.variable("rhoh", {"time", "zh"}, "kg m-3", {1, 1, 1, thin(0), thin(1000), thin(3000)}, NC_DOUBLE);
  options.profile = file.close();
  expect(import_cloud(options));

  options.profile = text("# z(m) rho(kg/m3)\n0 1.2\n300 1.1\n");
  EXPECT_THAT(error_of(options),
              AllOf(HasSubstr("profile.txt"), HasSubstr("does not reach the cloud (found heights 0 to 300 m, needed")));
  options.profile = text("# z(m) rho(kg/m3)\n0 1.2\n3000 1100\n");
  EXPECT_THAT(error_of(options), HasSubstr("the density at 3000 m is 1100 kg/m3 (allowed 0.01 to 2 kg/m3)"));
  options.profile = text("0 1.2\n3000 1.1\n");
  EXPECT_THAT(error_of(options), HasSubstr("\"# z(m) rho(kg/m3)\" before the numbers"));
}

TEST_F(AirFiles, PressureAndTemperatureByHeightGiveDensityAndTemperature) {
  CloudImportOptions options = with([](NetcdfBuilder&) {});
  std::string lines = "# z(m) p(Pa) T(K)\n";
  for (int m = 0; m <= 1000; m += 10) {
    const double x = 1 - gravity * m / (heat_capacity * theta);
    lines += fmt::format("{} {:.10g} {:.10g}\n", m, 1e5 * std::pow(x, 3.5), theta * x);
  }
  options.profile = text(lines);
  expect_truth(import_cloud(options));
  options.temperature_grid = true;
  const ImportedCloud cloud = import_cloud(options);
  ASSERT_EQ(cloud.auxiliaries.size(), 1U);
  EXPECT_NEAR(cloud.auxiliaries[0].value[0], kelvin(3), 2e-4);

  // A potential temperature of the file takes the profile's pressure.
  CloudImportOptions dry =
      with([](NetcdfBuilder& file) { file.variable("th", {"z"}, "K", profile([](int) { return theta + 3; })); });
  dry.profile = options.profile;
  dry.temperature_grid = true;
  EXPECT_NEAR(import_cloud(dry).auxiliaries[0].value[0], kelvin(3) * (theta + 3) / theta, 2e-4);
}

TEST_F(AirFiles, VariablesComeFromFurtherFiles) {
  NetcdfBuilder other(folder_ / "air.nc");
  other.dimension("time", 1);
  other.dimension("z", nz);
  other.variable("rho", {"time", "z"}, "kg/m3", profile(density));
  other.variable("qc", {"z"}, "kg/kg", profile([](int) { return 7; }));
  const std::filesystem::path air = other.close();
  CloudImportOptions options = with([](NetcdfBuilder&) {});
  EXPECT_THAT(error_of(options), HasSubstr("--with FILE (more variables)"));
  options.with = {air};
  expect_truth(import_cloud(options));  // its own water, the density of the other file

  NetcdfBuilder short_one(folder_ / "short.nc");
  short_one.dimension("z", nz - 1);
  short_one.variable("rho", {"z"}, "kg/m3", profile(density, nz - 1));
  options.with = {short_one.close()};
  EXPECT_THAT(error_of(options), HasSubstr("'rho' (air density): dimension 'z' is not one of the cloud's"));
}

// -- species ----------------------------------------------------------------------------------------------------------

class SpeciesImport : public LesImport {
 protected:
  static double ice(int k, int j, int i) { return k < 5 || k > 8 ? 0 : 2e-5 * (k + j + 1 + 2 * i); }
  CloudImportOptions cold(const std::vector<std::string>& species, bool has_water = true) const {
    CloudImportOptions options = with(
        [](NetcdfBuilder& file) {
          file.variable("rho", {"z"}, "kg/m3", profile(density));
          file.variable("T", {"z"}, "K", profile(kelvin));
          file.variable("qi", {"z", "y", "x"}, "g/kg", field([](int k, int j, int i) { return 1e3 * ice(k, j, i); }));
          file.variable("re_ice", {"z"}, "um", profile([](int k) { return 20 + k; }));
          file.variable("qr", {"z", "y", "x"}, "kg/kg", field([](int, int, int) { return 0; }));
        },
        has_water);
    options.species = species;
    return options;
  }
};

TEST_F(SpeciesImport, EachHasAGridOnItsOwnVoxels) {
  for (const std::vector<std::string>& species : {std::vector<std::string>{"liquid", "ice"}, {"all"}}) {
    CloudImportOptions options = cold(species);
    options.temperature_grid = true;
    const ImportedCloud cloud = import_cloud(options);
    expect_truth(cloud);
    EXPECT_EQ(cloud.grid, "density");
    ASSERT_EQ(cloud.others.size(), 2U);
    const VdbCloudGrid &frozen = cloud.others[0], &warmth = cloud.others[1];
    EXPECT_EQ(frozen.grid, "ice_water_content");
    EXPECT_EQ(frozen.field.quantity, "ice_water_content");
    EXPECT_EQ(frozen.field.cells, cloud.field.cells);
    ASSERT_EQ(frozen.auxiliaries.size(), 1U);
    EXPECT_EQ(frozen.auxiliaries[0].grid, "reff_ice");
    const std::vector<float> dense = to_dense(frozen.field), hot = to_dense(warmth.field), wet = to_dense(cloud.field);
    std::size_t n = 0, active = 0;
    for (int k = 0; k < nz; ++k) {
      for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i, ++n) {
          EXPECT_NEAR(dense[n], 1e3 * ice(k, j, i) * density(k), 1e-6 * 1e3 * ice(k, j, i));
          if (dense[n] > 0) {
            EXPECT_NEAR(frozen.auxiliaries[0].value[active++], 20 + k, 1e-4);
          }
          EXPECT_NEAR(hot[n], dense[n] > 0 || wet[n] > 0 ? kelvin(k) : 0, 1e-3);
        }
      }
    }
    if (species.size() == 1) {
      EXPECT_THAT(notes_of(cloud), HasSubstr("rain_water_content: none at this time, no grid"));
    }
    EXPECT_THAT(notes_of(cloud), Not(HasSubstr("NOT imported")));
  }
}

TEST_F(SpeciesImport, IceAloneIsTheCloud) {
  const ImportedCloud cloud = import_cloud(cold({"ice"}, false));
  EXPECT_EQ(cloud.grid, "ice_water_content");
  EXPECT_EQ(cloud.field.quantity, "ice_water_content");
  EXPECT_NEAR(cloud.field.value[0] / (1e3 * ice(5, 0, 0) * density(5)), 1, 1e-6);
  ASSERT_EQ(cloud.auxiliaries.size(), 1U);
  EXPECT_EQ(cloud.auxiliaries[0].grid, "reff_ice");
  EXPECT_EQ(import_cloud(cold({"all"}, false)).grid, "ice_water_content");
}

TEST_F(SpeciesImport, WhatTheFileLacksIsNamed) {
  EXPECT_THAT(error_of(cold({"liquid", "snow"})),
              AllOf(HasSubstr("no variable of snow (looked for QS, qs"), HasSubstr("leave snow out of --species")));
  CloudImportOptions contradictory = cold({"ice"});
  contradictory.variable = "qc";
  EXPECT_THAT(error_of(contradictory), HasSubstr("--species: without liquid (found --variable"));
  contradictory = cold({"liquid"});
  contradictory.quantity = "extinction";
  EXPECT_THAT(error_of(contradictory), HasSubstr("--species: of water alone (found --quantity extinction)"));
  EXPECT_THAT(notes_of(import_cloud(cold({}))), HasSubstr("NOT imported: 'qi', cloud ice"));
  EXPECT_THAT(notes_of(import_cloud(cold({}))), HasSubstr("--species liquid,ice imports it"));
}

TEST_F(SpeciesImport, MoreThanOneFitOnAVdbFile) {
  CloudImportOptions options = cold({"liquid", "ice"});
  options.temperature_grid = true;
  const ImportedCloud cloud = import_cloud(options);
  VdbWriteOptions write;
  write.grid = cloud.grid;
  const auto path = folder_ / "species.vdb";
  write_cloud_vdb(path, cloud.field, write, cloud.auxiliaries, cloud.others);
  const CloudInfo info = describe_cloud_vdb(path);
  ASSERT_EQ(info.grids.size(), 4U);
  VdbReadOptions read;
  read.grid = "ice_water_content";
  const VdbCloud frozen = read_cloud_vdb(path, read);
  EXPECT_EQ(frozen.quantity, "ice_water_content");
  EXPECT_EQ(frozen.units, "g/m3");
  EXPECT_EQ(frozen.value, cloud.others[0].field.value);
  read.grid = "temperature";
  EXPECT_EQ(read_auxiliary_vdb(path, frozen, read).size(), frozen.value.size());
  read.grid = "reff_ice";
  EXPECT_EQ(read_auxiliary_vdb(path, frozen, read), cloud.others[0].auxiliaries[0].value);
}

// -- series -----------------------------------------------------------------------------------------------------------

TEST_F(LesImport, MomentsOfASeriesMayBeClear) {
  NetcdfBuilder file(folder_ / "series.nc");
  file.dimension("time", 3);
  add_axes(file);
  std::vector<double> values;
  for (int t = 0; t < 3; ++t) {
    const std::vector<double> moment = field([t](int k, int j, int i) { return t * water(k, j, i); });
    values.insert(values.end(), moment.begin(), moment.end());
  }
  file.variable("qc", {"time", "z", "y", "x"}, "kg/kg", values);
  file.variable("rho", {"z"}, "kg/m3", profile(density));
  CloudImportOptions options;
  options.file = file.close();
  EXPECT_EQ(count_times(options), 3U);
  EXPECT_THAT(error_of(options), HasSubstr("no cloud"));
  options.may_be_clear = true;
  EXPECT_TRUE(import_cloud(options).field.value.empty());
  options.time = 2;
  expect_truth(import_cloud(options), 2);
  EXPECT_EQ(count_times(with([](NetcdfBuilder& f) { f.variable("rho", {"z"}, "kg/m3", profile(density)); })), 1U);
}

}  // namespace
}  // namespace cloudbow
