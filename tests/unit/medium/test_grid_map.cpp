// Truth: coefficients written down beside their cells.
#include <gtest/gtest.h>

#include "cloudbow/medium/grid_map.hpp"

namespace cloudbow {
namespace {

// Cells 0, 1 in the first row of level 0 (i = 1, 2), cell 2 in the second of level 1 (i = 0).
OpticalGrid three_cells() {
  OpticalGrid grid;
  grid.box = {3, 2, 10, 10, 0, 0, {0, 5, 20}, true, {}};
  grid.row_begin = {0, 1, 1, 1, 2};
  grid.spans = {{1, 2, 0}, {0, 1, 2}};
  grid.absorption = {.1F, .2F, .3F};
  grid.scattering = {{1, 2, 3}, {10, 20, 30}};
  grid.layer_absorption = {.01, .02};
  grid.layer_scattering = {{.1, .2}, {0, .4}};
  return grid;
}

TEST(OpticalGrid, SpansLevelsAndExtinctionAreFound) {
  const OpticalGrid grid = three_cells();
  int spans = 0;
  grid.for_each_span([&](int k, int j, const RowSpan& span) {
    EXPECT_EQ(k, spans);
    EXPECT_EQ(j, spans);
    EXPECT_EQ(span.i, spans == 0 ? 1 : 0);
    ++spans;
  });
  EXPECT_EQ(spans, 2);
  EXPECT_EQ(grid.row(1, 0).size(), 0U);
  EXPECT_EQ(grid.first_cell(0), 0U);
  EXPECT_EQ(grid.first_cell(1), 2U);
  EXPECT_EQ(grid.first_cell(2), 3U);
  EXPECT_FLOAT_EQ(static_cast<float>(grid.extinction(1)), 22.2F);
}

TEST(GridMap, CellsAndLevelsComeFromWhereItSays) {
  const OpticalGrid grid = three_cells();
  GridMap map;
  map.box = {2, 1, 10, 20, 0, 0, {0, 5, 10, 20}, true, {}};
  map.level = {0, 1, 1};
  map.add(0, 1);
  map.add(1, GridMap::no_cell);
  map.end_row();
  map.end_row();
  map.add(1, 2);
  map.end_row();
  const OpticalGrid other = remap(grid, map);
  EXPECT_EQ(other.absorption, (std::vector<float>{.2F, 0, .3F}));
  EXPECT_EQ(other.scattering[1], (std::vector<float>{20, 0, 30}));
  EXPECT_EQ(other.layer_absorption, (std::vector<double>{.01, .02, .02}));
  EXPECT_EQ(other.layer_scattering[0], (std::vector<double>{.1, .2, .2}));
  ASSERT_EQ(other.spans.size(), 2U) << "neighbours are one span";
  EXPECT_EQ(other.spans[0].n, 2);
  EXPECT_EQ(other.row(1, 0).size(), 0U);
  EXPECT_EQ(other.row(2, 0).front().i, 1);
}

TEST(GridMap, EmptyCellsAreAddedWithoutMatter) {
  const OpticalGrid full = with_empty_cells(three_cells());
  EXPECT_EQ(full.absorption, (std::vector<float>{0, .1F, .2F, 0, 0, 0, 0, 0, 0, .3F, 0, 0}));
  EXPECT_EQ(full.scattering[0][9], 3);
  EXPECT_EQ(full.layer_absorption, three_cells().layer_absorption);
  for (int k = 0; k < 2; ++k) {
    for (int j = 0; j < 2; ++j) {
      ASSERT_EQ(full.row(k, j).size(), 1U);
      EXPECT_EQ(full.row(k, j).front().n, 3);
    }
  }
}

}  // namespace
}  // namespace cloudbow
