#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "transport/acceleration/coarsening.hpp"
#include "transport/system/transport_system.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

struct Fixture {
  Problem problem;
  TransportSystem<double> system;

  Fixture(double largest_extinction, int nx)
      : problem([&] {
          const BoxGrid box = make_box(nx, 14, 15);
          Problem of;
          of.grid = make_grid(box, random_extinction(box, largest_extinction, 3), .99);
          of.phase = {PhaseFunction::henyey_greenstein(.8)};
          return of;
        }()),
        system(make_system<double>(problem, discretise(problem.phase, std::nullopt, coarse_options()),
                                   coarse_options())) {}
};

// Cells of two by two by two, the topmost level by itself: absorption and scattering of the whole stay.
TEST(Coarsening, KeepsMatter) {
  const Fixture fine(.5, 16);
  const auto coarse = coarsen(fine.system);
  ASSERT_TRUE(coarse);
  const BoxGrid& box = coarse->grid.box;
  EXPECT_EQ(box.nx, 8);
  EXPECT_EQ(box.ny, 7);
  EXPECT_EQ(box.nz(), 8);
  EXPECT_EQ(box.dx_m, 2);
  double absorbed = 0, scattered = 0, fine_absorbed = 0, fine_scattered = 0;
  const std::vector<std::uint32_t> dense = dense_indices(coarse->grid);
  for (std::size_t c = 0; c < dense.size(); ++c) {
    const double volume = 4 * box.thickness_m(static_cast<int>(dense[c] / box.columns()));
    absorbed += volume * static_cast<double>(coarse->grid.absorption[c]);
    scattered += volume * static_cast<double>(coarse->grid.scattering[0][c]);
  }
  const Cells<double>& cells = *fine.system.cells;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    fine_absorbed += fine.system.absorption[c];
    fine_scattered += cells.scattered[0][c] * cells.extinction[c];
  }
  EXPECT_NEAR(absorbed, fine_absorbed, 1e-6 * fine_absorbed);  // coefficients are kept in float
  EXPECT_NEAR(scattered, fine_scattered, 1e-6 * fine_scattered);
}

TEST(Coarsening, SharesOfACoarseCellAddUpToOne) {
  const Fixture fine(.5, 16);
  const auto coarse = coarsen(fine.system);
  ASSERT_TRUE(coarse);
  std::vector<double> sum(coarse->grid.active_cells(), 0.);
  for (std::size_t c = 0; c < fine.system.cells->size(); ++c) sum[coarse->coarse_cell[c]] += coarse->share[c];
  for (const double shares : sum) EXPECT_NEAR(shares, 1, 1e-12);
}

// Light that stays within a coarse cell would not be corrected.
TEST(Coarsening, ThickCellsStayAsTheyAre) {
  EXPECT_FALSE(coarsen(Fixture(40, 16).system));
  EXPECT_FALSE(coarsen(Fixture(.5, 3).system));  // too few cells to pay
}

}  // namespace
}  // namespace cloudbow
