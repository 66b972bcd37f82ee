// Voxels of a grid by their indices. Truth: OpenVDB's accessor, and the grid's own list of voxels.
#include "vdb_reader_tools.hpp"

namespace cloudbow {
namespace {

using openvdb::Coord;

TEST_F(VdbFile, LookupsFindWhatTheAccessorFinds) {
  const auto grid = scattered_grid(0.5F);
  grid->tree().addTile(1, Coord(16, 0, 0), 3.0F, true);
  grid->tree().addTile(1, Coord(-24, 8, 8), 4.0F, false);
  grid->tree().setValueOff(Coord(1, 2, 3), 7.0F);
  const VdbGrid read = read_by_openvdb(write_seekable({grid}), "density");
  VdbLookup lookup(read);
  const auto accessor = grid->getConstAccessor();
  std::size_t active = 0;
  for (int i = -40; i < 40; ++i) {
    for (int j = -20; j < 30; ++j) {
      for (int k = -30; k < 30; ++k) {
        float value = 0;
        const bool is_active = accessor.probeValue(Coord(i, j, k), value);
        const auto found = lookup.at({i, j, k});
        ASSERT_EQ(found.is_active, is_active) << i << " " << j << " " << k;
        if (is_active) {
          ASSERT_EQ(found.value, value);
          ++active;
        } else {
          ASSERT_EQ(found.is_background, value == 0.5F) << i << " " << j << " " << k;
        }
      }
    }
  }
  EXPECT_EQ(read.active_voxels(), active);
}

TEST_F(VdbFile, TheBoxOfActiveVoxelsHasTilesAndSingleVoxels) {
  EXPECT_FALSE(active_box(VdbGrid{}));
  const auto grid = density_grid({{Coord(-3, 5, 1000), 1.0F}, {Coord(2, 70, 7), 2.0F}});
  grid->tree().addTile(2, Coord(128, 0, 0), 1.0F, true);
  const auto box = active_box(read_by_openvdb(write_seekable({grid}), "density"));
  const auto truth = grid->evalActiveVoxelBoundingBox();
  ASSERT_TRUE(box);
  for (int a = 0; a < 3; ++a) {
    EXPECT_EQ((*box)[0][a], truth.min()[a]);
    EXPECT_EQ((*box)[1][a], truth.max()[a]);
  }
}

TEST(VdbGrid, VoxelsOfTilesAreVisitedAfterThoseOfLeaves) {
  VdbGrid grid;
  grid.active_tiles.push_back({{8, 0, 0}, 2, 5.0F});
  grid.leaves.emplace_back();
  VdbLeaf::set_on(grid.leaves[0].active, 64 + 8 + 1);
  grid.values = {3.0F};
  std::vector<std::pair<VdbIndex, float>> visited;
  for_each_active_voxel(grid, [&](const VdbIndex& index, float value) { visited.emplace_back(index, value); });
  ASSERT_EQ(visited.size(), 9U);
  EXPECT_EQ(visited[0], std::pair(VdbIndex{1, 1, 1}, 3.0F));
  EXPECT_EQ(visited[1], std::pair(VdbIndex{8, 0, 0}, 5.0F));
  EXPECT_EQ(visited[2], std::pair(VdbIndex{8, 0, 1}, 5.0F));
  EXPECT_EQ(visited[8], std::pair(VdbIndex{9, 1, 1}, 5.0F));
}

}  // namespace
}  // namespace cloudbow
