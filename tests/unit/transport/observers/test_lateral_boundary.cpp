// Light at open sides. Truth: layers alone, solved as one column.
#include <gtest/gtest.h>

#include <vector>

#include "cloudbow/medium/cloud_makers.hpp"
#include "cloudbow/sphere/interpolation_weights.hpp"
#include "cloudbow/transport/solver.hpp"
#include "solve_test_tools.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

TEST(Solve, LayersShineInThroughOpenSides) {
  // A box with open sides that holds nothing but a layer. Radiance at the sides is that of the layer itself. The light
  // is thus that of the infinite layer (whose surface is black inside and outside).
  const Layer layer{0, 4, 1., .9, 0};
  const CloudField speck =
      make_cloud_field({4, 4, 16}, {2, 2, .25}, {0, 0, 0}, std::vector<float>(256, 1e-9F), "extinction");
  const auto grid = [&](bool periodic) {
    return make_optical_grid(&speck, {}, {layer}, {0, 0, 0}, {8, 8, 4}, periodic, 1, {0.}, {});
  };
  SolverOptions options = coarse();
  options.tolerance = 1e-6;
  const Solution open = solve(problem_of(grid(false), PhaseFunction::isotropic()), options);
  const Solution periodic = solve(problem_of(grid(true), PhaseFunction::isotropic()), options);
  expect_finite_and_closed(open, 1e-5);
  // Incident light is linear between the 16 levels' interfaces, but radiance is concave: .1 % of it is missing.
  EXPECT_NEAR(open.ledger.reflectance, periodic.ledger.reflectance, 1e-3);
  EXPECT_NEAR(open.ledger.transmittance, periodic.ledger.transmittance, 1e-3);
  EXPECT_NEAR(open.ledger.side_gain / open.ledger.side_loss, 1, 2e-3);
}

}  // namespace
}  // namespace cloudbow
