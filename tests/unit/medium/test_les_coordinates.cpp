// Coordinates of LES files. Truth: the numbers that the files are made of.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "les_test_tools.hpp"

namespace cloudbow {
namespace {

using namespace les_test;
using testing::HasSubstr;

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

}  // namespace
}  // namespace cloudbow
