// Output of `cloud info`. Truth: integrals by hand.
#include "vdb_test_tools.hpp"

namespace cloudbow {
namespace {

using openvdb::Coord;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

namespace fs = std::filesystem;

using CloudDescription = VdbFile;

TEST_F(CloudDescription, TheDescriptionTellsWhatIsThere) {
  const auto bad = density_grid({{Coord(0, 0, 0), -1.0F}}, "bad");
  const auto velocity = openvdb::Vec3SGrid::create();
  velocity->setName("velocity");
  const auto good = density_grid({{Coord(0, 0, 0), 0.5F}, {Coord(1, 0, 0), 0.25F}});
  good->insertMeta("quantity", openvdb::StringMetadata("extinction"));
  good->insertMeta("units", openvdb::StringMetadata("1/m"));
  const CloudInfo info = describe_cloud_vdb(write_stream({good, bad, velocity}));
  ASSERT_EQ(info.grids.size(), 3U);
  EXPECT_EQ(info.bytes, fs::file_size(file()));
  ASSERT_TRUE(info.grids[0].cloud.has_value());
  EXPECT_EQ(info.grids[0].cloud->active_voxels, 2U);
  EXPECT_THAT(info.grids[1].reason, HasSubstr("voxel (0, 0, 0) has the value -1"));
  EXPECT_THAT(info.grids[2].reason, HasSubstr("wrong type"));
  EXPECT_THAT(format_cloud_info(info),
              AllOf(HasSubstr("extinction [1/m]"), HasSubstr("optical depth: min 0.25, mean 0.375, max 0.5"),
                    HasSubstr("cells           2 x 1 x 1 of 1 x 1 x 1 m"), HasSubstr("Tree_vec3s_5_4_3")));
}

TEST_F(CloudDescription, OneGridMayBeAskedForAndAnotherAxisMayPointUp) {
  const auto tall = density_grid({{Coord(0, 0, 0), 0.5F}, {Coord(0, 1, 0), 0.25F}});
  const auto other = density_grid({{Coord(0, 0, 0), 7.0F}}, "smoke");
  const fs::path path = write_stream({tall, other});
  const CloudInfo smoke = describe_cloud_vdb(path, "smoke");
  ASSERT_EQ(smoke.grids.size(), 1U);
  EXPECT_EQ(smoke.grids[0].cloud->value.max, 7);
  EXPECT_THAT(describe_cloud_vdb(path, "density").grids[0].cloud->cells, ElementsAre(1, 2, 1));
  EXPECT_THAT(describe_cloud_vdb(path, "density", "y").grids[0].cloud->cells, ElementsAre(1, 1, 2));
  EXPECT_THAT(message_of([&] { describe_cloud_vdb(path, "fog"); }),
              HasSubstr("no grid \"fog\" (found \"density\", \"smoke\") name one of these"));
}

// Ice of 3 um beside water without radii: the radii are not the water's.
TEST_F(CloudDescription, WaterOfOtherSpeciesHasAPathOfItsOwn) {
  const auto field = [](const char* quantity) {
    return make_cloud_field({1, 1, 2}, {10, 10, 10}, {0, 0, 0}, {2, 0}, quantity);
  };
  write_cloud_vdb(file(), field("liquid_water_content"), {}, {},
                  {{"ice_water_content", field("ice_water_content"), {{"reff_ice", "effective_radius", "um", {3}}}}});
  const std::string text = format_cloud_info(describe_cloud_vdb(file()));
  EXPECT_THAT(text, AllOf(HasSubstr("ice_water_content [g/m3]"), HasSubstr("ice water path [g/m2]: mean 20")));
  EXPECT_THAT(text, Not(HasSubstr("optical depth")));
}

// 2 g/m3 of 3 um droplets over 10 m: 1.5 * 2 / 3 * 10.
TEST_F(CloudDescription, TheDescriptionHasOpticalDepthByTheRadiusOfTheFile) {
  const CloudField water = make_cloud_field({2, 1, 1}, {10, 10, 10}, {0, 0, 0}, {2, 0}, "liquid_water_content");
  const auto described = [&](float radius) {
    write_cloud_vdb(file(), water, {}, {{"reff", "effective_radius", "um", {radius}}});
    return describe_cloud_vdb(file());
  };
  const CloudInfo info = described(3);
  ASSERT_TRUE(info.grids[0].optical_depth.has_value());
  EXPECT_NEAR(info.grids[0].optical_depth->max, 10, 1e-5);
  EXPECT_THAT(format_cloud_info(info),
              AllOf(HasSubstr("all columns     liquid water path [g/m2]: mean 10\n"),
                    HasSubstr("all columns     optical depth, by the effective radius: mean 5\n")));
  EXPECT_THAT(doubts_about(info), testing::IsEmpty());
  check_effective_radii(info);

  write_cloud_vdb(file(), water);
  EXPECT_THAT(format_cloud_info(describe_cloud_vdb(file())), Not(HasSubstr("optical depth")));

  for (const float radius : {3e-6F, 6000.0F}) {  // in m; in nm
    EXPECT_THAT(message_of([&] { check_effective_radii(described(radius)); }),
                AllOf(HasSubstr("grid \"reff\""), HasSubstr("0.1 to 5000 um")));
  }
}

TEST_F(CloudDescription, NumbersThatNoCloudHasAreDoubted) {
  const auto doubts = [&](float value, const char* quantity) {
    write_cloud_vdb(file(), make_cloud_field({1, 1, 1}, {10, 10, 10}, {0, 0, 0}, {value}, quantity));
    return doubts_about(describe_cloud_vdb(file()));
  };
  EXPECT_THAT(doubts(2005, "liquid_water_content"), ElementsAre(HasSubstr("2005 g/m3")));
  EXPECT_THAT(doubts(19, "liquid_water_content"), testing::IsEmpty());
  EXPECT_THAT(doubts(1100, "extinction"), ElementsAre(HasSubstr("1.1e+04")));
  EXPECT_THAT(doubts(900, "extinction"), testing::IsEmpty());

  const auto per_km = density_grid({{Coord(0, 0, 0), 30.0F}});
  per_km->insertMeta("quantity", openvdb::StringMetadata("extinction"));
  per_km->insertMeta("units", openvdb::StringMetadata("km^-1"));
  const CloudInfo info = describe_cloud_vdb(write_seekable({per_km}));
  EXPECT_THAT(doubts_about(info), ElementsAre(HasSubstr("cloud.scale = 0.001")));
  EXPECT_THAT(format_cloud_info(info), HasSubstr("vertical integral"));
}

TEST_F(CloudDescription, IntegralsAreNamedByQuantityAndUnits) {
  EXPECT_EQ(column_integral_name("extinction", "1/m"), "optical depth");
  EXPECT_EQ(column_integral_name("extinction", ""), "optical depth");
  EXPECT_EQ(column_integral_name("extinction", "1/km"), "vertical integral");
  EXPECT_EQ(column_integral_name("liquid_water_content", "g/m3"), "liquid water path [g/m2]");
  EXPECT_EQ(column_integral_name("liquid_water_content", "kg/m3"), "vertical integral");
  EXPECT_EQ(column_integral_name("rain_water_content", "g/m3"), "rain water path [g/m2]");
}

TEST_F(CloudDescription, NamesOutOfFilesDoNotReachTheTerminal) {
  const auto grid = density_grid({{Coord(0, 0, 0), 1.0F}}, "den\x1b[2Jsity");
  grid->insertMeta("quantity", openvdb::StringMetadata("ex\ntinction"));
  EXPECT_THAT(format_cloud_info(describe_cloud_vdb(write_seekable({grid}))),
              AllOf(HasSubstr("den\\x1b[2Jsity"), HasSubstr("ex\\x0atinction"), Not(HasSubstr("\x1b"))));
}

}  // namespace
}  // namespace cloudbow
