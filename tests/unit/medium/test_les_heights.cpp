// Heights of levels in LES files. Truth: sums by hand over the numbers that the files are made of.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

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

/// Edges of levels over a hill, of thickness that differs from column to column.
double terrain_edge(int k, int j, int i) { return 35.0 * i + 10.0 * j + k * (40 + 1.7 * j - 0.6 * i) + 0.2 * k * k; }

void expect_paths(const ImportedCloud& cloud, const std::vector<double>& wanted, double tolerance = 1e-6) {
  const std::vector<double> found = paths(cloud.field);
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t c = 0; c < found.size(); ++c) EXPECT_NEAR(found[c] / wanted[c], 1, tolerance) << c;
}

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

}  // namespace
}  // namespace cloudbow
