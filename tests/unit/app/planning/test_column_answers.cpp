// Truth: the independent columns of the whole field, and the energy of each.
#include <gtest/gtest.h>

#include <numbers>
#include <numeric>
#include <vector>

#include "app/planning/column_answers.hpp"
#include "cloudbow/transport/probe_columns.hpp"
#include "cloudbow/transport/solver.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

Problem sunlit() {
  const BoxGrid box = make_box(6, 5, 4);
  Problem problem;
  problem.grid = make_grid(box, random_extinction(box, 3, 5), .9);
  problem.phase = {PhaseFunction::henyey_greenstein(.85)};
  problem.sun = Sun{travel_along(-.6, 20), 7.};
  problem.surface.albedo = .2;
  return problem;
}

Problem glowing() {
  Problem problem = sunlit();
  problem.sun.reset();
  problem.sky_radiance = .1;
  problem.grid.planck.assign(problem.grid.active_cells(), 2.F);
  problem.grid.planck_step.assign(problem.grid.active_cells(), -.1F);
  problem.grid.layer_planck.assign(4, 2.);
  problem.grid.layer_planck_step.assign(4, -.1);
  problem.surface.planck_map.assign(30, 3.F);
  problem.surface.planck_map[7] = 4;
  return problem;
}

std::vector<std::size_t> all_columns(const Problem& problem) {
  std::vector<std::size_t> columns(problem.grid.box.columns());
  std::iota(columns.begin(), columns.end(), std::size_t{0});
  return columns;
}

Solution solved(const Problem& problem) {
  SolverOptions options;
  options.independent_columns = true;
  return solve(problem, options);
}

// The same columns in another arrangement: rounding of float. Column 7 has ground of its own.
TEST(ColumnAnswers, AreThoseOfTheField) {
  for (const Problem& problem : {sunlit(), glowing()}) {
    const Solution whole = solved(problem);
    const std::vector<std::size_t> columns{7, 3, 29};
    const ColumnAnswers answers = column_answers(problem, coarse_options(), columns);
    ASSERT_EQ(answers.up.size(), 3U);
    const std::size_t top = whole.upwelling_flux.size() - 30;
    for (std::size_t n = 0; n < 3; ++n) {
      const std::size_t c = columns[n];
      const double tolerance = 2e-6 * answers.power;
      EXPECT_NEAR(answers.up[n] * answers.power, whole.upwelling_flux[top + c], tolerance);
      EXPECT_NEAR(answers.down[n] * answers.power,
                  static_cast<double>(whole.downwelling_diffuse_flux[c] + whole.direct_flux[c]), tolerance);
      double absorbed = 0;
      for (std::size_t k = 0; k < 4; ++k) absorbed += whole.absorbed_power[k * 30 + c];
      EXPECT_NEAR(answers.absorbed[n] * answers.power, absorbed, tolerance);
    }
  }
}

TEST(ColumnAnswers, OfAllColumnsHaveThePowerOfTheField) {
  for (const Problem& problem : {sunlit(), glowing()}) {
    const ColumnAnswers answers = column_answers(problem, coarse_options(), all_columns(problem));
    EXPECT_NEAR(answers.power, solved(problem).ledger.power, 1e-6 * answers.power);
    if (problem.sun) {
      EXPECT_NEAR(answers.power, .6 * 7, 1e-6);
    }
  }
}

// Sunlight is reflected, absorbed, or kept by the ground.
TEST(ColumnAnswers, ConserveEnergy) {
  const Problem problem = sunlit();
  const ColumnAnswers answers = column_answers(problem, coarse_options(), all_columns(problem));
  for (std::size_t c = 0; c < answers.up.size(); ++c)
    EXPECT_NEAR(answers.up[c] + .8 * answers.down[c] + answers.absorbed[c], 1, 3e-6);
  double heating = 0, absorbed = 0;  // levels of 1 m
  for (const double value : answers.heating) heating += value;
  for (const double value : answers.absorbed) absorbed += value / 30;
  EXPECT_NEAR(heating, absorbed, 1e-12);
}

// A Lambertian ground by another name.
TEST(ColumnAnswers, OfGroundWithABrdfHaveItsMeanAlbedo) {
  Problem problem = sunlit();
  const ColumnAnswers truth = column_answers(problem, coarse_options(), all_columns(problem));
  problem.surface.brdf = SurfaceBrdf::lambertian(.2);
  problem.surface.albedo = 0;
  const ColumnAnswers found = column_answers(problem, coarse_options(), all_columns(problem));
  for (std::size_t c = 0; c < truth.up.size(); ++c) EXPECT_NEAR(found.up[c], truth.up[c], 1e-4);
}

TEST(ColumnAnswers, OfADarkSceneHaveNoPower) {
  Problem problem = sunlit();
  problem.sun.reset();
  EXPECT_EQ(column_answers(problem, coarse_options(), all_columns(problem)).power, 0);
}

// Fluxes, images and all else that options may ask for make no difference.
TEST(ColumnAnswers, AskForNothingElse) {
  const Problem problem = sunlit();
  SolverOptions options = coarse_options();
  const ColumnAnswers truth = column_answers(problem, options, all_columns(problem));
  options.views.push_back({"nadir", {0, 0, 1}});
  options.radiance_field = options.actinic = options.collapse_uniform_axes = true;
  options.flux_levels = FluxLevels::listed;
  options.listed_levels = {1};
  EXPECT_EQ(column_answers(problem, options, all_columns(problem)).up, truth.up);
}

}  // namespace
}  // namespace cloudbow
