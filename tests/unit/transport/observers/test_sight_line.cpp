// Lines of sight one by one. Truth: Beer's law and the formal solution in closed form, along paths worked out by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "gather_test_tools.hpp"
#include "transport/observers/sight_line.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

// 4 x 3 x 5 cells of 10 m, all active, over a ground whose columns shine with 1, 2, 3, ...
struct Scene {
  BoxGrid box;
  Cells<double> cells;
  GroundRadiance<double> ground;
  std::vector<double> slope_x, flat;

  Scene(bool periodic, double extinction)
      : box(make_box(4, 3, 5, periodic)), ground{{}, AngularField<double>(1, 12), {}} {
    box.dx_m = box.dy_m = 10;
    box.z_edge_m = {0, 10, 20, 30, 40, 50};
    cells = make_cells<double>(make_grid(box, std::vector<float>(60, static_cast<float>(extinction)), 1.), untruncated,
                               false);
    for (std::size_t c = 0; c < 12; ++c) ground.at_points.row(0)[c] = static_cast<double>(c + 1);
    slope_x.assign(cells.size() + lane_padding, 0.);
    flat = slope_x;
  }
  SightScene<double> sight(double sky = 0, SideRadiance side = {}) const {
    return {box, cells, {slope_x.data(), flat.data(), flat.data()}, ground, sky, std::move(side)};
  }
};

const auto no_source = [](std::uint32_t) { return 0.; };
const auto bright = [](std::uint32_t) { return 3.; };

TEST(SightLine, StraightDownSeesTheGroundOfItsColumnByBeer) {
  const Scene scene(true, .01);
  const auto sight = scene.sight();
  // Column (2, 1) is the 7th; from above the top the path is the whole depth, from the middle the rest of it.
  EXPECT_NEAR(radiance_along(sight, {25, 15, 500}, {0, 0, -1}, no_source), 7 * std::exp(-.5), 1e-7);
  EXPECT_NEAR(radiance_along(sight, {25, 15, 33}, {0, 0, -1}, no_source), 7 * std::exp(-.33), 1e-7);
}

TEST(SightLine, UniformSourceFillsWhatIsNotTransmitted) {
  const Scene scene(true, .02);
  const auto sight = scene.sight(5.);
  for (const double mu : {1., .4, .03}) {
    const Direction up(std::sqrt(1 - mu * mu) * .8, std::sqrt(1 - mu * mu) * -.6, mu);
    const double through = std::exp(-.02 * (50 - 7) / mu);
    EXPECT_NEAR(radiance_along(sight, {3, 29, 7}, up, bright), 3 * (1 - through) + 5 * through,
                5e-4);  // if less than 1e-4 is transmitted, the rest is taken to be as bright
  }
}

TEST(SightLine, GoesOnAtTheOtherSideOfPeriodicAir) {
  const Scene scene(true, 0.005);
  const auto sight = scene.sight();
  // 45 degrees towards -x from x = 5 m: at the ground it stands 45 m further, x = -40 or 0 of the next domain.
  const Direction slanted = Direction(-1, 0, -1).normalized();
  EXPECT_NEAR(radiance_along(sight, {6, 15, 45}, slanted, no_source), 5 * std::exp(-.005 * 45 * std::sqrt(2.)),
              1e-7);  // column (0, 1)
  EXPECT_NEAR(radiance_along(sight, {4, 15, 45}, slanted, no_source), 8 * std::exp(-.005 * 45 * std::sqrt(2.)),
              1e-7);  // column (3, 1)
}

TEST(SightLine, OpenSidesShowWhatStandsThere) {
  const Scene scene(false, .01);
  std::vector<double> by_edge{10, 11, 12, 13, 14, 15};
  const auto sight = scene.sight(2., [&](const Direction&) { return by_edge; });
  // Level with z = 25: leaves through x = 40 after 12 m, with a side radiance of 12.5.
  EXPECT_NEAR(radiance_along(sight, {28, 15, 25}, {1, 0, 0}, no_source), 12.5 * std::exp(-.12), 1e-6);
  // From outside: nothing until the domain, all 40 m of it, and the other side.
  EXPECT_NEAR(radiance_along(sight, {-500, 15, 25}, {1, 0, 0}, no_source), 12.5 * std::exp(-.4), 1e-6);
  // Past the domain.
  EXPECT_NEAR(radiance_along(sight, {-500, 15, 25}, {-1, 0, 0}, no_source), 2., 0);
  EXPECT_NEAR(radiance_along(sight, {-500, 15, 100}, Direction(-1, 0, -1).normalized(), no_source), 10., 0);
}

TEST(SightLine, SourceIsLinearWithinACell) {
  // One cell of t = .4 seen along x: S = 3 (1 + .5 (x - 5)/10) from .75 to 1.25 of 3. Nearest the eye first.
  Scene scene(false, .04);
  std::fill(scene.slope_x.begin(), scene.slope_x.end(), .5);
  const auto sight = scene.sight(0., [](const Direction&) { return std::vector<double>(6, 0.); });
  const auto only_first = [&](std::uint32_t cell) { return cell % 4 == 0 ? 3. : 0.; };
  // int_0^t S(s) e^-s ds with S = 3 (.75 + .5 s/t).
  const double t = .4, e = std::exp(-t);
  const double truth = 3 * (.75 * (1 - e) + .5 / t * (1 - e * (1 + t)));
  EXPECT_NEAR(radiance_along(sight, {0, 15, 25}, {1, 0, 0}, only_first), truth, 1e-7);
}

TEST(SightLine, ConstantSourceIsALinearOneWithoutSlopes) {
  const Scene scene(true, .02);
  const SightScene<double> constant(scene.box, scene.cells, {}, scene.ground, 5., {});
  EXPECT_TRUE(constant.linear_cells.empty());
  const auto by_cell = [](std::uint32_t cell) { return 1. + cell % 7; };
  for (const Direction& line :
       {Direction(0, 0, -1), Direction(.5, .7, -.2).normalized(), Direction(-1, 0, .3).normalized()})
    EXPECT_NEAR(radiance_along(constant, {13, 17, 23}, line, by_cell),
                radiance_along(scene.sight(5.), {13, 17, 23}, line, by_cell), 1e-13);
}

TEST(SightLine, TakesWallsAndCornersInItsStride) {
  const Scene scene(true, .01);
  const auto sight = scene.sight(1.);
  // Starts on walls and edges, along axes and diagonals: uniform cells see the same length whatever the order of walls.
  for (const Direction& line :
       {Direction(0, 0, 1), Direction(1, 1, 1).normalized(), Direction(-1, 0, 1).normalized()}) {
    for (const Eigen::Vector3d& eye :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(20, 10, 0), Eigen::Vector3d(40, 30, 0)}) {
      const double through = std::exp(-.5 / line.z());
      EXPECT_NEAR(radiance_along(sight, eye, line, bright), 3 * (1 - through) + through, 1e-6);
    }
  }
}

}  // namespace
}  // namespace cloudbow
