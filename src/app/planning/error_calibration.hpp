// Errors from the distances between a solution and its coarse solves, by level of accuracy: measured
// (docs/accuracy.md).
#pragma once

#include <string>

#include "cloudbow/results/error_estimate.hpp"
#include "cloudbow/transport/solve_plan.hpp"

namespace cloudbow {

/// How a scene and its coarse solves are solved.
enum class SolvedAs {
  field,
  column,                 ///< one, with iteration
  column_beside_streams,  ///< one, with iteration, if columns without it have the same fluxes, but exactly
  column_by_its_streams   ///< one, without iteration
};

/// @param one_column of AssembledScene; fields that do not vary and are solved as one count too.
SolvedAs solved_as(const SolvePlan& plan, bool one_column);

/// Weights for estimate_error() at a level of accuracy.
ErrorWeights error_weights(const std::string& accuracy, SolvedAs as);

/// Estimated error of a level over that of `draft` in the same scene, as expected before the level is solved.
ByFlux error_ratio_to_draft(const std::string& accuracy, SolvedAs as);

}  // namespace cloudbow
