#include <gtest/gtest.h>

#include <vector>

#include "transport/reduction/uniform_axes.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

// Extinction that changes along y and z alone.
Problem rolls(bool periodic = true) {
  const BoxGrid box = make_box(4, 3, 2, periodic);
  std::vector<float> extinction;
  for (std::size_t c = 0; c < cells_of(box); ++c) extinction.push_back(static_cast<float>(1 + c / 4));
  Problem problem;
  problem.grid = make_grid(box, extinction, .9);
  problem.phase = {PhaseFunction::isotropic()};
  return problem;
}

TEST(UniformAxes, AreThoseAlongWhichNothingVaries) {
  const UniformAxes axes = uniform_axes(rolls());
  EXPECT_TRUE(axes.x);
  EXPECT_FALSE(axes.y);
  EXPECT_FALSE(uniform_axes(rolls(false)).any());

  Problem on_a_map = rolls();
  on_a_map.surface.albedo_map.assign(12, .2F);
  EXPECT_TRUE(uniform_axes(on_a_map).x);
  on_a_map.surface.albedo_map[5] = .3F;
  EXPECT_FALSE(uniform_axes(on_a_map).any());

  Problem one_voxel = rolls();
  one_voxel.grid.absorption[3] *= 1.0001F;
  EXPECT_FALSE(uniform_axes(one_voxel).any());
}

TEST(UniformAxes, CollapsedProblemHasOneCellAlongThem) {
  const Problem whole = rolls();
  const Problem slice = collapse(whole, {true, false});
  EXPECT_EQ(slice.grid.box.nx, 1);
  EXPECT_EQ(slice.grid.box.ny, 3);
  ASSERT_EQ(slice.grid.active_cells(), 6U);
  for (std::size_t c = 0; c < 6; ++c) EXPECT_EQ(slice.grid.scattering[0][c], whole.grid.scattering[0][4 * c]);
}

TEST(UniformAxes, SolutionIsTheSameAlongThem) {
  const Problem whole = rolls();
  Solution solution;
  solution.box = collapse(whole, {true, false}).grid.box;
  solution.flux_level = {0, 2};
  solution.upwelling_flux = {1, 2, 3, 4, 5, 6};
  spread(whole, {true, false}, solution);
  EXPECT_EQ(solution.box.nx, 4);
  const std::vector<float> expected{1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 6, 6, 6, 6};
  EXPECT_EQ(std::vector<float>(solution.upwelling_flux.begin(), solution.upwelling_flux.end()), expected);
}

}  // namespace
}  // namespace cloudbow
