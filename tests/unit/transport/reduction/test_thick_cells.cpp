// Cells too thick to be solved are refused.
#include <gtest/gtest.h>

#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/transport/thick_cells.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

Problem two_cells(float lower, float upper, double single_scattering_albedo) {
  Problem problem;
  problem.grid = make_grid(make_box(1, 1, 2), {lower, upper}, single_scattering_albedo);
  problem.phase = {PhaseFunction::henyey_greenstein(.85)};
  return problem;
}

TEST(ThickCells, AreRefusedWhereTheirLightDrownsInRounding) {
  EXPECT_NO_THROW(check_cell_thickness(two_cells(1, 9e5F, .9)));
  EXPECT_THROW(check_cell_thickness(two_cells(1, 2e6F, .9)), InputError);
  EXPECT_THROW(check_cell_thickness(two_cells(2e6F, 1, .9)), InputError);
  EXPECT_NO_THROW(check_cell_thickness(two_cells(1, 1e30F, 0)));  // Beer's law needs no diffuse light
}

}  // namespace
}  // namespace cloudbow
