// Grids as OpenVDB reads them, without its types. Truth: the grids that were written.
#include "vdb_reader_tools.hpp"

namespace cloudbow {
namespace {

using openvdb::Coord;

TEST_F(VdbFile, OpenVdbsGridIsTranslated) {
  const auto grid = density_grid({{Coord(0, 0, 1), 1.5F}, {Coord(9, 0, 0), 2.5F}});
  grid->tree().addTile(1, Coord(8, 8, 8), 3.0F, true);
  grid->tree().setValueOff(Coord(0, 0, 2), 4.0F);
  grid->insertMeta("quantity", openvdb::StringMetadata("extinction"));
  grid->insertMeta("domain_min_m", openvdb::Vec3IMetadata({-1, -2, -3}));
  grid->insertMeta("domain_max_m", openvdb::StringMetadata("far"));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  const VdbGrid read = read_by_openvdb(write_seekable({grid}), "density");
  EXPECT_EQ(read.header.quantity, "extinction");
  EXPECT_EQ(read.header.units, "");
  EXPECT_TRUE(read.header.is_level_set);
  EXPECT_EQ(read.header.voxel_count, 514);
  EXPECT_EQ(read.header.domain_min_m->value, (std::array<double, 3>{-1, -2, -3}));
  EXPECT_EQ(read.header.domain_max_m->wrong_type, "string");
  ASSERT_EQ(read.leaves.size(), 2U);
  EXPECT_EQ(read.leaves[1].origin, (VdbIndex{8, 0, 0}));
  EXPECT_EQ(read.values, (std::vector<float>{1.5F, 2.5F}));
  ASSERT_EQ(read.active_tiles.size(), 1U);
  EXPECT_EQ(read.active_tiles[0].edge, 8);
  EXPECT_EQ(read.inactive.voxels, 1U);
  EXPECT_EQ(read.inactive.example, 4.0F);
}

TEST_F(VdbFile, ChecksStopTheReadingBeforeTheVoxels) {
  const auto path = write_seekable({scattered_grid()});
  const VdbGridChecks of_header{[](const VdbGridHeader&) { throw InputError("the header"); },
                                [](double) { ADD_FAILURE() << "the voxels were read"; }};
  EXPECT_EQ(message_of([&] { read_grid_by_openvdb(path, "density", gigabyte, of_header); }), "the header");
  const VdbGridChecks of_voxels{[](const VdbGridHeader&) {},
                                [](double voxels) {
                                  EXPECT_GT(voxels, 800);
                                  throw InputError("the voxels");
                                }};
  EXPECT_EQ(message_of([&] { read_grid_by_openvdb(path, "density", gigabyte, of_voxels); }), "the voxels");
}

}  // namespace
}  // namespace cloudbow
