// Cheaper solutions of a scene, which tell how far off its solution is.
#pragma once

#include "cloudbow/results/error_estimate.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Fewer directions of everything, fluxes at the highest and the lowest level alone.
/// @param one_column as accuracy_options() takes it.
SolverOptions companion_options(const SolverOptions& options, bool one_column);

/// Both companions of a solution by `options`.
Companions solve_companions(const Problem& problem, const SolverOptions& options, bool one_column,
                            const ProgressCallback& progress);

/// Wall seconds of them, as predict_seconds().
double predict_companion_seconds(const Problem& problem, const SolverOptions& options, bool one_column);

}  // namespace cloudbow
