// What distances between a solution and its companions mean, level by level: measured (docs/error-estimates.md).
#pragma once

#include <string>

#include "cloudbow/results/error_estimate.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Weights for estimate_error() at a level of accuracy.
/// @param one_column as accuracy_options() takes it.
ErrorWeights error_weights(const std::string& accuracy, bool one_column);

/// Estimated error of a level over that of `draft` in the same scene, as expected before the level is solved.
ByFlux error_ratio_to_draft(const std::string& accuracy, bool one_column);

}  // namespace cloudbow
