// Truth: the columns that they are taken from.
#include <gtest/gtest.h>

#include <vector>

#include "cloudbow/transport/probe_columns.hpp"
#include "cloudbow/transport/solver.hpp"
#include "transport/reduction/subdivided_levels.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

Problem field(const BoxGrid& box, const std::vector<float>& extinction) {
  Problem problem;
  problem.grid = make_grid(box, extinction, .99);
  problem.phase = {PhaseFunction::henyey_greenstein(.85)};
  problem.sun = Sun{travel_along(-.6, 20), 1.};
  return problem;
}

SolverOptions exact() {
  SolverOptions options;
  options.independent_columns = true;
  return options;
}

TEST(ProbeColumns, OfFewColumnsAreAllOfThem) {
  const BoxGrid box = make_box(4, 2, 5);
  Problem problem = field(box, random_extinction(box, 2, 5));
  problem.surface.albedo_map = {0, .1F, .2F, .3F, .4F, .5F, .6F, .7F};
  const Solution whole = solve(problem, exact());
  const Solution probe = solve(probe_columns(SolvePlan(problem, SolverOptions{})), exact());
  EXPECT_EQ(probe.box.columns(), 8U);
  EXPECT_NEAR(probe.ledger.reflectance, whole.ledger.reflectance, 1e-7);
  EXPECT_NEAR(probe.ledger.transmittance, whole.ledger.transmittance, 1e-7);
}

TEST(ProbeColumns, OfManyAreTheMediansOfTheirClasses) {
  const BoxGrid box = make_box(10, 8, 1);
  std::vector<float> extinction(80);
  for (std::size_t c = 0; c < 80; ++c) extinction[c] = static_cast<float>(c * 37 % 80);  // each number once
  const Problem problem = field(box, extinction);
  const Problem probe = probe_columns(SolvePlan(problem, SolverOptions{}));
  ASSERT_EQ(probe.grid.absorption.size(), 8U);
  for (std::size_t n = 0; n < 8; ++n) {
    const float found = probe.grid.absorption[n] + probe.grid.scattering[0][n];
    EXPECT_NEAR(found, static_cast<float>(10 * n + 5), 1e-4F);
  }
}

TEST(ProbeColumns, HaveTheLevelsThatAreSolved) {
  const Problem problem = field(make_box(2, 1, 3), {8, 8, 8, 8, 8, 8});
  SolverOptions options;
  options.max_level_optical_depth = 2;
  const int added = subdivide_thick_levels(problem, options).added(problem.grid.box);
  ASSERT_GT(added, 0);
  EXPECT_EQ(probe_columns(SolvePlan(problem, options)).grid.box.nz(), 3 + added);
}

}  // namespace
}  // namespace cloudbow
