// Trees with tiles of all sizes. Truth: OpenVDB reads the same leaves, tiles and values, in the same order.
#include "vdb_reader_tools.hpp"

namespace cloudbow {
namespace {

using openvdb::Coord;

TEST_F(VdbFile, TilesOfAllLevelsAreReadInTheOrderOfTheTree) {
  for (const float background : {0.0F, 2.0F}) {
    const auto grid = scattered_grid(background);
    for (const bool active : {true, false}) {
      const int shift = active ? 0 : 64;
      grid->tree().addTile(1, Coord(40 + shift, -8, 16), 1.5F, active);
      grid->tree().addTile(1, Coord(-200, 8 + shift, -16), 2.5F, active);
      grid->tree().addTile(1, Coord(1000, 1000, 1000 + shift), 2.5F, active);
      grid->tree().addTile(2, Coord(256, 128 + 4 * shift, -128), 3.5F, active);
    }
    grid->tree().addTile(3, Coord(-8192, 0, 0), 4.5F, false);
    grid->tree().addTile(3, Coord(8192, 4096, 0), 5.5F, false);
    grid->tree().addTile(3, Coord(0, 4096, -4096), 6.5F, false);
    grid->tree().setValueOn(Coord(4096, 4095, 1), 9.0F);
    expect_same_reading(write_seekable({grid}));
    expect_same_reading(write_stream({grid}));
  }
}

TEST_F(VdbFile, BlocksOfConstantValueAreRead) {
  const auto grid = openvdb::FloatGrid::create(0.0F);
  grid->setName("density");
  grid->fill(openvdb::CoordBBox(Coord(-8, -8, 0), Coord(15, 7, 23)), 0.5F);
  grid->fill(openvdb::CoordBBox(Coord(128, 128, 128), Coord(255, 255, 255)), 0.25F);
  grid->fill(openvdb::CoordBBox(Coord(126, 130, 200), Coord(129, 140, 203)), 0.75F);
  expect_same_reading(write_seekable({grid}));
}

TEST_F(VdbFile, AnEmptyTreeIsReadAsEmpty) {
  const auto grid = openvdb::FloatGrid::create(0.0F);
  grid->setName("density");
  expect_same_reading(write_seekable({grid}));
}

TEST_F(VdbFile, GridsThatNeedTooMuchMemoryAreLeftToOpenVdb) {
  const auto grid = density_grid({{Coord(0, 0, 0), 1.0F}});
  grid->tree().addTile(2, Coord(128, 0, 0), 1.0F, true);
  const auto path = write_seekable({grid});
  EXPECT_TRUE(read_plain_vdb(path, "density", 100'000'000));
  EXPECT_FALSE(read_plain_vdb(path, "density", 80'000'000));  // 40 bytes for each of 2 million voxels
  grid->tree().addTile(3, Coord(4096, 0, 0), 1.0F, true);
  EXPECT_FALSE(read_plain_vdb(write_seekable({grid}), "density", 1000 * gigabyte));
}

TEST_F(VdbFile, IndicesAtTheEndsOfTheirRangeAreRead) {
  const auto grid = density_grid({{Coord::min(), 1.0F}, {Coord::max(), 2.0F}, {Coord(-1, -1, -1), 3.0F}});
  const auto path = write_seekable({grid});
  const auto plain = read_plain_vdb(path, "density", gigabyte);
  ASSERT_TRUE(plain);
  expect_same_grid(*plain, read_by_openvdb(path, "density"));
}

}  // namespace
}  // namespace cloudbow
