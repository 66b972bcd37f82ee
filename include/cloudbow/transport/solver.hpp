// From a problem to its solution.
#pragma once

#include <cstddef>

#include "cloudbow/core/ranks.hpp"
#include "cloudbow/transport/cell_light.hpp"
#include "cloudbow/transport/checkpoints.hpp"
#include "cloudbow/transport/solution.hpp"
#include "cloudbow/transport/solve_plan.hpp"

namespace cloudbow {

/// Beside the plan of a solve. Null: none.
struct SolveMeans {
  /// From which the iteration begins and to which it writes its state. Solves without iteration leave none.
  Checkpoints* checkpoints = nullptr;
  /// That share the solve, without checkpoints. All call solve() with equal plans. The first has the solution, the
  /// others have an empty one.
  Ranks* ranks = nullptr;
  /// The iteration starts from it, if both plans are of one problem. Only the parts of its cells may differ. Then it is
  /// the light of this solve, at all ranks. It stays as it is if light does not leave its column. It also does if
  /// cells without matter are solved too.
  CellLight* light = nullptr;
};

/// Solves the problem. @throws InputError for options out of range (names of ordinate sets, counts of control points);
/// for light out of range; and for cells too thick to be solved (thick_cells.hpp).
/// @throws std::runtime_error if a value of the solution is not finite, or the iteration diverges.
Solution solve(const SolvePlan& plan, const ProgressCallback& progress = {}, SolveMeans means = {});
Solution solve(const Problem& problem, const SolverOptions& options, const ProgressCallback& progress = {},
               Checkpoints* checkpoints = nullptr);

/// Peak memory in bytes of solve(): .8 to 1.4 of what runs took. @throws InputError as solve() for rays that cross
/// too many cells.
/// @param ranks that share the solve: the memory is that of each.
std::size_t predict_memory(const SolvePlan& plan, int ranks = 1);
/// Wall seconds on the machine of predict_phases(): .45 to 1.25 of runs.
double predict_seconds(const SolvePlan& plan);

}  // namespace cloudbow
