#include <gtest/gtest.h>

#include <vector>

#include "transport/grid/cells.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

// Delta-M: of the scattering, the fraction f counts as unscattered.
TEST(Cells, ForwardPeakIsTruncated) {
  const BoxGrid box = make_box(2, 1, 1);
  const OpticalGrid grid = make_grid(box, {.5F, .25F}, {{1.F, 2.F}, {3.F, 0.F}});
  const std::vector<double> fraction{.5, .25};
  const Cells<double> cells = make_cells<double>(grid, fraction, false);
  ASSERT_EQ(cells.size(), 2U);
  EXPECT_DOUBLE_EQ(cells.extinction[0], .5 + .5 * 1 + .75 * 3);
  EXPECT_DOUBLE_EQ(cells.extinction[1], .25 + .5 * 2);
  EXPECT_DOUBLE_EQ(cells.scattered[0][0] * cells.extinction[0], .5 * 1);
  EXPECT_DOUBLE_EQ(cells.scattered[1][0] * cells.extinction[0], .75 * 3);
  EXPECT_EQ(cells.scattered[1][1], 0);
}

TEST(ActiveRows, ChunksHaveEachCellOnceAndInItsPlace) {
  const BoxGrid box = make_box(21, 3, 4);
  const OpticalGrid grid = make_grid(box, random_extinction(box, 1, 5), .5);
  const ActiveRows rows = active_rows(grid);
  std::vector<std::uint32_t> place(rows.size(), no_place);
  for (int k = 0; k < rows.nz; ++k) {
    for (const Chunk& chunk : rows.levels.of(k)) {
      EXPECT_GE(chunk.n, 1);
      EXPECT_LE(chunk.n, lanes);
      for (int i = 0; i < chunk.n; ++i) {
        std::uint32_t& at = place[chunk.cell + static_cast<std::uint32_t>(i)];
        EXPECT_EQ(at, no_place);
        at = static_cast<std::uint32_t>((k * rows.ny + chunk.row) * rows.nx + chunk.column + i);
      }
    }
  }
  EXPECT_EQ(place, dense_indices(grid));
  EXPECT_EQ(place, dense_indices(rows));
}

// Differences are central between cells, one-sided at bottom and top, and none beside a gap.
TEST(Cells, NeighboursAreThoseOfTheDifferences) {
  const BoxGrid box = make_box(4, 1, 2);
  const std::vector<float> extinction{1, 1, 1, 0, /* level 1: */ 1, 1, 1, 1};
  const OpticalGrid grid = make_grid(box, extinction, 0.);
  const Cells<double> cells = make_cells<double>(grid, std::vector<double>{0.}, false);
  ASSERT_EQ(cells.size(), 7U);
  const auto slope = [&](std::size_t axis, std::size_t c) {
    const std::vector<double> source{1, 2, 4, 8, 16, 32, 64};
    return cells.scale[axis][c] * (source[cells.high[axis][c]] - source[cells.low[axis][c]]);
  };
  EXPECT_DOUBLE_EQ(slope(0, 1), (4 - 1) / 2.);    // between its neighbours
  EXPECT_DOUBLE_EQ(slope(0, 2), 0);               // the next column is empty
  EXPECT_DOUBLE_EQ(slope(0, 3), (16 - 64) / 2.);  // over the seam
  EXPECT_DOUBLE_EQ(slope(2, 0), 8 - 1);           // from the bottom up
  EXPECT_DOUBLE_EQ(slope(2, 6), 0);               // alone in its column
  const Cells<double> columns = make_cells<double>(grid, std::vector<double>{0.}, true);
  EXPECT_DOUBLE_EQ(columns.scale[0][1] * 3, 0);
}

TEST(Cells, LightComesFromLevelsThatScatterOrEmit) {
  const BoxGrid box = make_box(2, 1, 3);
  OpticalGrid grid = make_grid(box, {1, 1, 1, 1, 1, 1}, {{0, 0, 0, 2, 0, 0}});
  grid.planck = {1, 0, 0, 0, 0, 0};
  grid.planck_step.assign(6, 0.F);
  const Cells<double> cells = make_cells<double>(grid, std::vector<double>{0.}, false);
  EXPECT_TRUE(cells.sends_light(0));
  EXPECT_TRUE(cells.sends_light(1));
  EXPECT_FALSE(cells.sends_light(2));
}

}  // namespace
}  // namespace cloudbow
