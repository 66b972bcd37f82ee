// From a problem to its solution.
#pragma once

#include <cstddef>

#include "cloudbow/core/ranks.hpp"
#include "cloudbow/transport/checkpoints.hpp"
#include "cloudbow/transport/solution.hpp"
#include "cloudbow/transport/solve_plan.hpp"

namespace cloudbow {

/// Solves the problem. @throws InputError for options out of range (names of ordinate sets, counts of control points);
/// for light out of range; and for cells too thick to be solved (thick_cells.hpp).
/// @throws std::runtime_error if a value of the solution is not finite, or the iteration diverges.
/// @param checkpoints from which the iteration begins and to which it writes its state, or null; solves without
/// iteration leave none.
/// @param ranks that share the solve, without checkpoints; all call this with equal plans. The first has the solution,
/// the others have an empty one. Null: this process alone.
Solution solve(const SolvePlan& plan, const ProgressCallback& progress = {}, Checkpoints* checkpoints = nullptr,
               Ranks* ranks = nullptr);
Solution solve(const Problem& problem, const SolverOptions& options, const ProgressCallback& progress = {},
               Checkpoints* checkpoints = nullptr);

/// Peak memory in bytes that solve() will need, within about 10 %. @throws InputError as solve() for rays that cross
/// too many cells.
std::size_t predict_memory(const SolvePlan& plan);
/// Wall seconds on this machine, a rough prediction from segment counts.
double predict_seconds(const SolvePlan& plan);

}  // namespace cloudbow
