#include <gtest/gtest.h>

#include <vector>

#include "transport/columns/distinct_columns.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

Problem of_columns(const std::vector<float>& of_column) {
  const BoxGrid box = make_box(static_cast<int>(of_column.size()), 1, 2);
  std::vector<float> extinction = of_column;
  extinction.insert(extinction.end(), of_column.begin(), of_column.end());
  Problem problem;
  problem.grid = make_grid(box, extinction, .9);
  problem.phase = {PhaseFunction::isotropic()};
  return problem;
}

TEST(ColumnCells, AreThoseOfEachColumnFromTheBottomUp) {
  const Problem problem = of_columns({1, 0, 2});
  const ColumnCells cells = column_cells(problem.grid);
  EXPECT_EQ(std::vector<std::uint32_t>(cells.of(0).begin(), cells.of(0).end()), (std::vector<std::uint32_t>{0, 2}));
  EXPECT_TRUE(cells.of(1).empty());
  EXPECT_EQ(std::vector<std::uint32_t>(cells.of(2).begin(), cells.of(2).end()), (std::vector<std::uint32_t>{1, 3}));
}

TEST(DistinctColumns, EqualOnesAreSolvedOnce) {
  const Problem problem = of_columns({1, 2, 1, 0, 2, 1, 0});
  const DistinctColumns distinct = distinct_columns(problem, column_cells(problem.grid), std::nullopt);
  EXPECT_EQ(distinct.first, (std::vector<std::uint32_t>{0, 1, 3}));
  std::vector<int> visits(7, 0);
  for (std::uint32_t column : distinct.first) {
    const float here = std::vector<float>{1, 2, 1, 0, 2, 1, 0}[column];
    for (;;) {
      ++visits[column];
      EXPECT_EQ((std::vector<float>{1, 2, 1, 0, 2, 1, 0})[column], here);
      if (distinct.next[column] == column) break;
      column = distinct.next[column];
    }
  }
  EXPECT_EQ(visits, std::vector<int>(7, 1));
}

TEST(DistinctColumns, GroundOfAnotherAlbedoIsAnotherColumn) {
  Problem problem = of_columns({1, 1});
  EXPECT_EQ(distinct_columns(problem, column_cells(problem.grid), std::nullopt).first.size(), 1U);
  problem.surface.albedo_map = {.1F, .2F};
  EXPECT_EQ(distinct_columns(problem, column_cells(problem.grid), std::nullopt).first.size(), 2U);
}

}  // namespace
}  // namespace cloudbow
