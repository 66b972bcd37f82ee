// Broadband runs of small scenes, as the command makes them.
#pragma once

#include <string>
#include <vector>

#include "app/planning/broadband.hpp"
#include "app/planning/cost_estimate.hpp"
#include "cloudbow/transport/solver.hpp"
#include "gas_scene.hpp"
#include "usual_memory.hpp"

namespace cloudbow::broadband_tools {

inline const std::string settings =
    "[solver]\naccuracy = \"draft\"\n[output]\nerror_estimate = false\nfields = [\"fluxes\", \"absorption\"]\n"
    "[domain]\nmax_m = [400, 300, 20000]\n";

inline RunOptions options_for(int threads) {
  RunOptions options;
  options.quiet = true;
  options.threads = threads;
  return options;
}

inline BroadbandRun run(const std::vector<Scene>& scenes, int threads = 1) {
  CloudFiles files(true);
  const CostEstimate cost = estimate_cost(scenes, memory, threads, false, files);
  return solve_broadband(scenes, cost, options_for(threads), memory, files);
}

/// Each g-point by itself, at the levels of all.
inline std::vector<Solution> single_solves(const std::vector<Scene>& scenes) {
  CloudFiles files(true);
  const CostEstimate cost = estimate_cost(scenes, memory, 1, false, files);
  std::vector<Solution> solutions;
  for (const Scene& scene : scenes) solutions.push_back(solve(plan_scene(scene, memory, files, cost.levels_m, 1).plan));
  return solutions;
}

inline void expect_same_bits(const Solution& a, const Solution& b) {
  EXPECT_EQ(a.box.z_edge_m, b.box.z_edge_m);
  EXPECT_EQ(a.upwelling_flux, b.upwelling_flux);
  EXPECT_EQ(a.downwelling_diffuse_flux, b.downwelling_diffuse_flux);
  EXPECT_EQ(a.direct_flux, b.direct_flux);
  EXPECT_EQ(a.profile_upwelling_flux, b.profile_upwelling_flux);
  EXPECT_EQ(a.absorbed_power, b.absorbed_power);
  EXPECT_EQ(a.ledger.power, b.ledger.power);
  EXPECT_EQ(a.ledger.absorptance, b.ledger.absorptance);
}

}  // namespace cloudbow::broadband_tools
