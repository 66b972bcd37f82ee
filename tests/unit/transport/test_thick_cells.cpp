// What thick absorbing cells lose. Truth: columns without azimuths, which are exact in the vertical.
#include <gtest/gtest.h>

#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/transport/thick_cells.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

// Four cells one above the other, the lowest first.
Problem slab(const std::vector<float>& extinction, double single_scattering_albedo, double g) {
  const BoxGrid box = make_box(1, 1, static_cast<int>(extinction.size()));
  Problem problem;
  problem.grid = make_grid(box, extinction, single_scattering_albedo);
  problem.phase = {PhaseFunction::henyey_greenstein(g)};
  problem.sun = Sun{travel_along(-.64, 37), 1.};
  return problem;
}

SolverOptions sweeps() {
  SolverOptions options;
  options.control_points = 42;
  options.directions = "double-gauss-6x8";
  options.tolerance = 1e-3;
  return options;
}

TEST(ThickCells, LoseAboutWhatIsTold) {
  SolverOptions columns;
  columns.independent_columns = true;
  columns.column_streams = 16;
  for (const double g : {0., .85}) {
    for (const double ssa : {.9, .99}) {
      for (const float depth : {5.F, 20.F, 200.F}) {
        const Problem problem = slab(std::vector<float>(4, depth), ssa, g);
        const double lost = solve(problem, columns).ledger.reflectance - solve(problem, sweeps()).ledger.reflectance;
        const double told = light_lost_in_thick_cells(problem, sweeps());
        // A formula for all phase functions and suns: right to a factor of two, rather too much.
        if (lost > .02) {
          EXPECT_GT(told, .75 * lost) << g << ' ' << ssa << ' ' << depth;
        }
        EXPECT_LT(told, 2 * lost + .01) << g << ' ' << ssa << ' ' << depth;
      }
    }
  }
}

TEST(ThickCells, LoseAboutWhatIsToldWhereTheyAreAlone) {
  SolverOptions columns;
  columns.independent_columns = true;
  columns.column_streams = 16;
  for (const double g : {0., .85}) {
    for (const float depth : {2.F, 10.F, 100.F}) {
      for (const std::vector<float>& extinction : {std::vector<float>{depth}, {.001F, depth, .001F}, {0, 0, depth}}) {
        const Problem problem = slab(extinction, 1, g);
        const double lost = solve(problem, columns).ledger.reflectance - solve(problem, sweeps()).ledger.reflectance;
        const double told = light_lost_in_thick_cells(problem, sweeps());
        EXPECT_GT(told, .6 * lost - .01) << g << ' ' << depth << ' ' << extinction.size();
        EXPECT_LT(told, 2.5 * lost + .02) << g << ' ' << depth << ' ' << extinction.size();
      }
    }
  }
}

TEST(ThickCells, NothingIsLostWhereCellsAreThinOrDoNotAbsorbOrAreNotSeen) {
  EXPECT_EQ(light_lost_in_thick_cells(slab({1, 1, 1, 1}, .9, .85), sweeps()), 0);
  EXPECT_EQ(light_lost_in_thick_cells(slab({500, 500, 500, 500}, 1, .85), sweeps()), 0);
  EXPECT_EQ(light_lost_in_thick_cells(slab({500, 500, 500, 500}, 0, .85), sweeps()), 0);
  SolverOptions columns;
  columns.independent_columns = true;
  EXPECT_EQ(light_lost_in_thick_cells(slab({500, 500, 500, 500}, .9, .85), columns), 0);
  // Thick below thin ones of the same kind: no light of theirs gets back to the top.
  std::vector<float> extinction(20, 1.F);
  extinction.front() = 50;
  EXPECT_LT(light_lost_in_thick_cells(slab(extinction, .9, .85), sweeps()), 1e-4);
}

TEST(ThickCells, AreRefusedWhereTheirLightDrownsInRounding) {
  EXPECT_NO_THROW(check_cell_thickness(slab({1, 9e5F}, .9, .85)));
  EXPECT_THROW(check_cell_thickness(slab({1, 2e6F}, .9, .85)), InputError);
  EXPECT_NO_THROW(check_cell_thickness(slab({1, 1e30F}, 0, .85)));  // Beer's law needs no diffuse light
}

}  // namespace
}  // namespace cloudbow
