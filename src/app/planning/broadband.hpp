// Broadband runs: g-points of a gas model, solved and summed.
#pragma once

#include <cstdint>
#include <vector>

#include "app/planning/cost_estimate.hpp"
#include "app/planning/run_options.hpp"
#include "app/planning/solve_scenes.hpp"
#include "cloudbow/io/result_file.hpp"
#include "cloudbow/results/band_profile.hpp"

namespace cloudbow {

struct BroadbandRun {
  Solved solved;                   ///< one solution, the sum
  SpectralInfo info;               ///< how it was made
  std::vector<BandProfile> bands;  ///< if the scene asks for them
};

/// Solves a scene at the g-points of its gas model: all, or a few that stand for all, or all as independent columns.
/// Two solutions at most are in memory. @param scenes one for each g-point. @throws Interrupted.
BroadbandRun solve_broadband(const std::vector<Scene>& scenes, const CostEstimate& cost, const RunOptions& options,
                             std::uint64_t available, CloudFiles& files);

}  // namespace cloudbow
