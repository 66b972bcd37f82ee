// Clouds written as OpenVDB. Truth: what is written is read.
#include <gmock/gmock.h>

#include <iterator>

#include "vdb_test_tools.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

namespace fs = std::filesystem;

TEST_F(VdbFile, VoxelsThatOpenVdbTakesForSingularAreNotWritten) {
  EXPECT_THAT(message_of([&] {
                write_cloud_vdb(file(), make_cloud_field({1, 1, 1}, {1e-300, 50, 50}, {0, 0, 0}, {1.0F}, "extinction"));
              }),
              AllOf(HasSubstr("voxel size: too small"), HasSubstr("1e-300")));
  EXPECT_FALSE(fs::exists(file()));
}

TEST_F(VdbFile, HalfKeepsElevenBits) {
  const CloudField field =
      make_cloud_field({3, 1, 1}, {1, 1, 1}, {0, 0, 0}, {0.0123F, 1.7F, 65504.0F}, "liquid_water_content");
  write_cloud_vdb(file(), field, {.grid = "lwc", .half = true});
  const CloudField read = read_cloud_vdb(file(), {.grid = "lwc"});
  EXPECT_EQ(read.quantity, "liquid_water_content");
  ASSERT_EQ(read.value.size(), 3U);
  for (std::size_t n = 0; n < 3; ++n) EXPECT_NEAR(read.value[n], field.value[n], 0x1p-11 * field.value[n]);
  EXPECT_EQ(describe_cloud_vdb(file()).grids.at(0).type, "float stored as half");
}

TEST_F(VdbFile, ValuesTooLargeForHalfAreNotWritten) {
  const CloudField field = make_cloud_field({2, 1, 1}, {1, 1, 1}, {0, 0, 0}, {1, 1e5F}, "");
  EXPECT_THAT(message_of([&] { write_cloud_vdb(file(), field, {.half = true}); }),
              HasSubstr("voxel (1, 0, 0) has the value 100000"));
  EXPECT_FALSE(fs::exists(file()));
}

TEST_F(VdbFile, WritingIntoNothingIsAnError) {
  EXPECT_THAT(message_of([&] { write_cloud_vdb(file("no/such/folder.vdb"), small_field()); }),
              AllOf(HasSubstr("can't be written"), HasSubstr("there is no folder")));
  fs::create_directory(file("taken"));
  EXPECT_THAT(message_of([&] { write_cloud_vdb(file("taken"), small_field()); }), HasSubstr("can't be written"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

}  // namespace
}  // namespace cloudbow
