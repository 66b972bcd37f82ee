#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "vdb_test_tools.hpp"

namespace cloudbow {
namespace {

using testing::ElementsAre;

namespace fs = std::filesystem;

TEST_F(VdbFile, WhatIsWrittenIsRead) {
  const CloudField field = small_field();
  write_cloud_vdb(file(), field);
  const CloudField read = read_cloud_vdb(file());
  EXPECT_EQ(read.cells, field.cells);
  EXPECT_EQ(read.cell_size_m, field.cell_size_m);
  EXPECT_EQ(read.min_m, field.min_m);
  EXPECT_EQ(read.value, field.value);
  EXPECT_EQ(read.row_begin, field.row_begin);
  EXPECT_EQ(read.quantity, "extinction");
  EXPECT_EQ(to_dense(read), to_dense(field));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1) << "nothing but the file itself may be left";
}

/// Fields of the literature, outside the project: $CLOUDBOW_REFERENCE_DIR/fields.
class ReferenceFields : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("CLOUDBOW_REFERENCE_DIR");
    if (folder == nullptr) GTEST_SKIP() << "CLOUDBOW_REFERENCE_DIR is not set";
    fields_ = fs::path(folder) / "fields";
  }
  fs::path fields_;
};

TEST_F(ReferenceFields, Rico) {
  const CloudField field = read_cloud_vdb(fields_ / "rico32.vdb");
  EXPECT_THAT(field.cells, ElementsAre(32, 37, 38));
  EXPECT_THAT(field.cell_size_m, ElementsAre(20, 20, 40));
  EXPECT_EQ(field.min_m[2], -20);
  EXPECT_EQ(field.active_voxels(), 3943U);
}

TEST_F(ReferenceFields, StepCloud) {
  const auto depths = column_depths(read_cloud_vdb(fields_ / "step_cloud.vdb"));
  ASSERT_EQ(depths.size(), 32U);
  for (std::size_t i = 0; i < 32; ++i) EXPECT_NEAR(depths[i], i < 16 ? 2 : 18, 1e-5);  // 32-bit values
}

TEST_F(ReferenceFields, LandsatHasTheOpticalDepthsOfItsTable) {
  const CloudField field = read_cloud_vdb(fields_ / "landsat.vdb");
  EXPECT_THAT(field.cells, ElementsAre(128, 128, 119));
  EXPECT_EQ(field.active_voxels(), 1261003U);
  std::ifstream table(fields_.parent_path() / "i3rc" / "landsat_optical_depth.csv");
  ASSERT_TRUE(table) << "the table of optical depths is missing";
  std::vector<double> expected;
  for (std::string line; std::getline(table, line);) {
    if (line.empty() || line[0] == '#' || std::isalpha(static_cast<unsigned char>(line[0])) != 0) continue;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) expected.push_back(std::stod(cell));
  }
  const auto depths = column_depths(field);
  ASSERT_EQ(expected.size(), depths.size());
  for (std::size_t n = 0; n < depths.size(); ++n)
    ASSERT_NEAR(depths[n], expected[n], 1e-5 * (1 + expected[n])) << "column " << n;
}

TEST_F(ReferenceFields, StratocumulusHasItsAlbedoVoxelByVoxel) {
  const auto path = fields_ / "stcu213.vdb";
  const CloudField cloud = read_cloud_vdb(path);
  EXPECT_THAT(cloud.cells, ElementsAre(64, 64, 16));
  const auto albedo = read_auxiliary_vdb(path, cloud, {.grid = "single_scattering_albedo"}, 0, 1);
  ASSERT_EQ(albedo.size(), cloud.active_voxels());
  EXPECT_GT(*std::min_element(albedo.begin(), albedo.end()), 0.9F);
}

}  // namespace
}  // namespace cloudbow
