// The cells along a line. Truth: paths worked out by hand, and places that any cell along a line must have.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "transport/rays/cell_walk.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

using Place = CellWalk::Place;

// 4 x 3 x 5 cells of 10 m.
BoxGrid box_of_tens(bool periodic) {
  BoxGrid box = make_box(4, 3, 5, periodic);
  box.dx_m = box.dy_m = 10;
  box.z_edge_m = {0, 10, 20, 30, 40, 50};
  return box;
}

std::vector<std::size_t> cells_along(CellWalk& walk) {
  std::vector<std::size_t> cells;
  for (; walk.is_inside(); walk.advance()) {
    if (walk.exit() > walk.entry()) cells.push_back(walk.cell());
  }
  return cells;
}

TEST(CellWalk, MeetsTheCellsOfAPathByHand) {
  const BoxGrid box = box_of_tens(false);
  CellWalk walk(box, {5, 15, 57}, Direction(3, 0, -4).normalized());
  EXPECT_NEAR(walk.entry(), 7 / .8, 1e-12);  // the top
  // x = 10.25 at the top and 7.5 more a level: columns 1, 1-2, 2, 2-3, 3, and out at x = 40 in level 1.
  EXPECT_EQ(cells_along(walk), (std::vector<std::size_t>{53, 41, 42, 30, 31, 19}));
  EXPECT_EQ(walk.place(), Place::beside);
  EXPECT_NEAR(walk.point(walk.entry()).x(), 40, 1e-12);
}

TEST(CellWalk, GoesOnThroughPeriodicAir) {
  const BoxGrid box = box_of_tens(true);
  CellWalk walk(box, {6, 15, 45}, Direction(-1, 0, -1).normalized());
  while (walk.is_inside()) walk.advance();
  EXPECT_EQ(walk.place(), Place::below);
  EXPECT_EQ(walk.column(), 4U);  // x = -39: the first column of the domain before
  CellWalk level(box, {6, 15, 45}, {0, 1, 0});
  int cells = 0;
  for (; level.is_inside(); level.advance()) ++cells;
  EXPECT_EQ(level.place(), Place::endless);
  EXPECT_EQ(cells, 2 + 3 * (sight::most_domains - 1));
}

TEST(CellWalk, UniformLevelsAreOneCell) {
  // Below and above them the cells are those of a walk through every column.
  const BoxGrid whole = box_of_tens(true);
  BoxGrid box = whole;
  box.uniform = {0, 1, 0, 0, 1};
  for (const Direction& sight : {Direction(-3, .2, -1), Direction(.1, 5, -2), Direction(7, -4, 1)}) {
    const Direction line = sight.normalized();
    const Eigen::Vector3d eye(6, 15, line.z() > 0 ? -20 : 70);
    CellWalk through(whole, eye, line), over(box, eye, line);
    const auto outside_uniform = [&](CellWalk& walk) {
      std::vector<std::size_t> cells;
      for (std::size_t cell : cells_along(walk)) {
        if (box.uniform[cell / box.columns()] == 0) cells.push_back(cell);
      }
      return cells;
    };
    EXPECT_EQ(outside_uniform(over), outside_uniform(through));
    EXPECT_EQ(over.place(), through.place());
    EXPECT_EQ(over.column(), through.column());
    EXPECT_NEAR(over.entry(), through.entry(), 1e-9);
  }
}

TEST(CellWalk, MissesWhatItDoesNotMeet) {
  EXPECT_EQ(CellWalk(box_of_tens(false), {-5, 15, 25}, {-1, 0, 0}).place(), Place::missed);
  EXPECT_EQ(CellWalk(box_of_tens(false), {-5, 35, 25}, {1, 0, 0}).place(), Place::missed);
  EXPECT_EQ(CellWalk(box_of_tens(true), {5, 15, 55}, {0, 0, 1}).place(), Place::missed);
  EXPECT_EQ(CellWalk(box_of_tens(true), {5, 15, 55}, {0, 0, -1}).place(), Place::inside);
}

TEST(CellWalk, SinglePeriodicColumnHasNoWalls) {
  BoxGrid box = make_box(1, 1, 2, true);
  CellWalk walk(box, {.3, .3, 0}, Direction(1, 1, .01).normalized());
  EXPECT_EQ(cells_along(walk), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(walk.place(), Place::above);
}

TEST(CellWalk, EveryStretchLiesInItsCell) {
  for (const bool periodic : {true, false}) {
    const BoxGrid box = box_of_tens(periodic);
    for (const Direction& sight : {Direction(.3, -.8, .2).normalized(), Direction(-.5, .1, -.6).normalized(),
                                   Direction(1, 1, 1).normalized(), Direction(0, -1, 0)}) {
      for (const Eigen::Vector3d& eye :
           {Eigen::Vector3d(13, 17, 23), Eigen::Vector3d(20, 10, 30), Eigen::Vector3d(39.9, .1, 49)}) {
        double before = 0;
        int steps = 0;
        CellWalk walk(box, eye, sight);
        for (; walk.is_inside() && steps < 300; walk.advance(), ++steps) {
          ASSERT_LT(walk.cell(), 60U);
          EXPECT_NEAR(walk.entry(), before, 1e-12);  // no gap
          before = std::max(walk.entry(), walk.exit());
          for (const double distance : {walk.entry(), before})
            EXPECT_LE(walk.from_centre(distance).cwiseAbs().maxCoeff(), .5 + 1e-12);  // rounding
        }
        EXPECT_GT(steps, 0);
      }
    }
  }
}

}  // namespace
}  // namespace cloudbow
