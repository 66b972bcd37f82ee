// Fields of the cells. Truth: the same light by directions, and absorption times actinic flux.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cloudbow/medium/cloud_makers.hpp"
#include "cloudbow/sphere/interpolation_weights.hpp"
#include "cloudbow/transport/solver.hpp"
#include "solve_test_tools.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

TEST(Solve, ActinicFluxAndRadianceFieldTellOfTheSameLight) {
  Problem problem = random_problem(true, 2, .9, .3);
  problem.sun.reset();  // so that all light is diffuse
  problem.sky_radiance = 1;
  SolverOptions options = coarse();
  options.actinic = true;
  options.radiance_field = true;
  const Solution solution = solve(problem, options);
  const std::size_t n = cells_of(problem.grid.box);
  ASSERT_EQ(solution.actinic_flux.size(), n);
  ASSERT_TRUE(solution.radiance_field.has_value());
  const RadianceField& field = *solution.radiance_field;
  ASSERT_EQ(field.direction.size(), 42U);
  ASSERT_EQ(field.voxel.size(), n);  // empty cells were made active
  ASSERT_EQ(field.radiance.size(), 42 * n);
  double sphere = 0;  // the triangles cover it once, all counter-clockwise
  for (const auto& [a, b, c] : field.triangle) {
    const double area = spherical_triangle_area(field.direction[a], field.direction[b], field.direction[c]);
    EXPECT_GT(area, 0);
    sphere += area;
  }
  EXPECT_NEAR(sphere, 4 * std::numbers::pi, 1e-10);
  const OrdinateSet quadrature = make_ordinate_set("control-points-42");
  double worst = 0, sum = 0, total = 0;
  for (std::size_t c = 0; c < n; ++c) {
    double integral = 0;
    for (int d = 0; d < quadrature.size(); ++d) {
      std::size_t m = 0;
      while ((field.direction[m] - quadrature.direction[d]).norm() > 1e-9) ASSERT_LT(++m, 42U);
      integral += quadrature.weight[d] * static_cast<double>(field.radiance[c * 42 + m]);
    }
    const auto [i, j, k] = field.voxel[c];
    const double actinic = static_cast<double>(solution.actinic_flux[(k * 5 + j) * 6 + i]);
    worst = std::max(worst, std::abs(integral / actinic - 1));
    sum += integral;
    total += actinic;
  }
  EXPECT_LT(worst, .05);             // two quadratures of some forty directions each
  EXPECT_NEAR(sum / total, 1, .01);  // on average they differ by less
}

TEST(Solve, ActinicFluxTimesAbsorptionIsAbsorbedPower) {
  Problem problem = random_problem(true, 2, .9, .3);
  SolverOptions options = coarse();
  options.actinic = true;
  const Solution solution = solve(problem, options);
  const auto dense = random_extinction(problem.grid.box, 2, 1);
  for (std::size_t c = 0; c < dense.size(); ++c) {
    const double absorption = static_cast<double>(static_cast<float>((1 - .9) * static_cast<double>(dense[c])));
    EXPECT_GT(solution.actinic_flux[c], 0);
    EXPECT_NEAR(solution.absorbed_power[c], absorption * static_cast<double>(solution.actinic_flux[c]),
                1e-6 * absorption + 1e-12);
  }
}

}  // namespace
}  // namespace cloudbow
