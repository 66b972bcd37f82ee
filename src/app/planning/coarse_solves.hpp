// Other solutions of a scene, from which the error of its solution is estimated.
#pragma once

#include <string>

#include "app/planning/error_calibration.hpp"
#include "cloudbow/core/ranks.hpp"
#include "cloudbow/results/error_estimate.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Other directions, fewer of everything (more for a single column at the coarser levels); fluxes at the highest and
/// the lowest level alone.
/// @param accuracy the level that `options` are of.
SolverOptions coarse_options(const SolverOptions& options, const std::string& accuracy, SolvedAs as);

/// The coarse solves beside the solution of a plan. @param coarse the same with its coarse_options().
/// @param ranks that share each of them; all call this, and the first has them. Null: this process makes them
CoarseSolves solve_coarsely(const SolvePlan& plan, const SolvePlan& coarse, SolvedAs as,
                            const ProgressCallback& progress, Ranks* ranks = nullptr);

/// Wall seconds of them, as predict_seconds().
double predict_coarse_seconds(const SolvePlan& plan, const SolvePlan& coarse, SolvedAs as);

}  // namespace cloudbow
