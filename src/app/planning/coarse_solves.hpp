// Other solutions of a scene, from which the error of its solution is estimated.
#pragma once

#include <string>

#include "app/planning/error_calibration.hpp"
#include "cloudbow/core/ranks.hpp"
#include "cloudbow/results/error_estimate.hpp"
#include "cloudbow/transport/cell_light.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// The problem of a plan with other directions, fewer of everything (more for a single column at the coarser levels).
/// Fields have fluxes at the highest and the lowest level and at few of those between.
/// @param accuracy the level that the plan's options are of.
SolvePlan coarse_plan(const SolvePlan& plan, const std::string& accuracy, SolvedAs as);

/// The coarse solves beside the solution of a plan. @param coarse its coarse_plan().
/// @param light of the solve of the plan, from which they start, at all ranks. Given up.
/// @param ranks that share each of them; all call this, and the first has them. Null: this process makes them
CoarseSolves solve_coarsely(const SolvePlan& plan, const SolvePlan& coarse, SolvedAs as,
                            const ProgressCallback& progress, CellLight light = {}, Ranks* ranks = nullptr);

/// Wall seconds of them, as predict_seconds().
double predict_coarse_seconds(const SolvePlan& plan, const SolvePlan& coarse, SolvedAs as);

}  // namespace cloudbow
