// Fluxes by level. Truth: those of all levels, whichever are asked for.
#include <gtest/gtest.h>

#include <vector>

#include "cloudbow/medium/cloud_makers.hpp"
#include "cloudbow/sphere/interpolation_weights.hpp"
#include "cloudbow/transport/solver.hpp"
#include "solve_test_tools.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

TEST(Solve, FluxLevelsAreThoseAskedFor) {
  const Problem problem = random_problem(true, 2, .9, .3);
  SolverOptions options = coarse();
  options.flux_levels = FluxLevels::all;
  const Solution all = solve(problem, options);
  EXPECT_EQ(all.flux_level, (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_EQ(all.upwelling_flux.size(), 5 * problem.grid.box.columns());
  options.flux_levels = FluxLevels::listed;
  options.listed_levels = {1, 4};
  const Solution listed = solve(problem, options);
  EXPECT_EQ(listed.flux_level, (std::vector<int>{1, 4}));
  ASSERT_EQ(listed.upwelling_flux.size(), 2 * problem.grid.box.columns());
  for (std::size_t l = 0; l < 2; ++l) {
    const auto e = static_cast<std::size_t>(listed.flux_level[l]);
    EXPECT_NEAR(mean_of_level(listed.upwelling_flux, listed.box, l), listed.profile_upwelling_flux[e], 1e-6);
    EXPECT_NEAR(mean_of_level(all.upwelling_flux, all.box, e), all.profile_upwelling_flux[e], 1e-6);
    EXPECT_NEAR(mean_of_level(all.downwelling_diffuse_flux, all.box, e), all.profile_downwelling_diffuse_flux[e], 1e-6);
    EXPECT_NEAR(mean_of_level(all.direct_flux, all.box, e), all.profile_direct_flux[e], 1e-6);
  }
}

}  // namespace
}  // namespace cloudbow
