// `cloudbow cloud make`, `info` and `refine`. Truth: the numbers that the command line states.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/planning/tradeoff.hpp"
#include "call_cloudbow.hpp"
#include "cloudbow/app/command_line.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/io/droplet_table_file.hpp"
#include "cloudbow/medium/vdb_file.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(CommandLine, CloudInfoDoubtsAndRefuses) {
  const TemporaryFolder folder;
  const CloudField field = make_cloud_field({1, 1, 1}, {50, 50, 100}, {0, 0, 0}, {2005}, "liquid_water_content");
  write_cloud_vdb(folder / "cloud.vdb", field, {}, {{"reff", "effective_radius", "um", {1e-5f}}});
  const Outcome outcome = cloudbow({"cloud", "info", folder / "cloud.vdb"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.output, HasSubstr("liquid water path"));
  EXPECT_THAT(outcome.errors, AllOf(HasSubstr("warning: "), HasSubstr("2005 g/m3"), HasSubstr("0.1 to 5000 um")));
}

TEST(CommandLine, MakesAndDescribesACloud) {
  const TemporaryFolder folder;
  const auto cloud = folder / "sphere.vdb";
  ASSERT_EQ(
      cloudbow({"cloud", "make", "sphere", "--cells", "6", "6", "6", "--voxel-size-m", "50", "50", "50", "-o", cloud})
          .exit_code,
      0);
  EXPECT_THAT(cloudbow({"cloud", "info", cloud}).output, HasSubstr("density"));
  EXPECT_EQ(cloudbow({"cloud", "info", folder / "none.vdb"}).exit_code, 2);
}

TEST(CommandLine, RefinesACloudWithTheGridsOfItsVoxels) {
  const TemporaryFolder folder;
  const CloudField field =
      make_cloud_field({2, 1, 2}, {50, 50, 100}, {0, 0, 0}, {.1F, .2F, .3F, 0}, "liquid_water_content");
  const CloudField ice = make_cloud_field({2, 1, 2}, {50, 50, 100}, {0, 0, 0}, {0, 0, 0, .1F}, "ice_water_content");
  write_cloud_vdb(folder / "cloud.vdb", field, {"water"}, {{"reff", "effective_radius", "um", {8, 9, 10}}},
                  {{"ice", ice, {}}});
  const Outcome outcome = cloudbow(
      {"cloud", "refine", folder / "cloud.vdb", "--grid", "water", "--factor", "3", "-o", folder / "fine.vdb"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.errors, AllOf(HasSubstr("grid \"ice\" has different voxels"), HasSubstr("--grid ice")));
  const VdbCloud fine = read_cloud_vdb(folder / "fine.vdb", {"water"});
  EXPECT_EQ(fine.cells, (std::array<int, 3>{6, 3, 6}));
  EXPECT_EQ(fine.quantity, "liquid_water_content");
  ASSERT_EQ(fine.active_voxels(), 3U * 27);
  const std::vector<float> radius = read_auxiliary_vdb(folder / "fine.vdb", fine, {"reff"});
  EXPECT_EQ(radius.front(), 8);
  EXPECT_EQ(radius.back(), 10);
  for (const char* factor : {"1", "9", "2.5"}) {
    const Outcome wrong =
        cloudbow({"cloud", "refine", folder / "cloud.vdb", "--factor", factor, "-o", folder / "none.vdb"});
    EXPECT_EQ(wrong.exit_code, 2);
    EXPECT_THAT(wrong.errors, HasSubstr("2 to 8"));
  }
  EXPECT_EQ(cloudbow({"cloud", "refine", folder / "fine.vdb", "--grid", "water", "-o", folder / "fine.vdb"}).exit_code,
            2)
      << "the input is not overwritten";
}

}  // namespace
}  // namespace cloudbow
