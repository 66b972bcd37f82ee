// The fit of one function to the control points by an interior-point method.
#pragma once

#include <optional>

#include "cloudbow/optics/sphere_fit.hpp"
#include "fit_programme.hpp"

namespace cloudbow {

/// X within a relative 1e-6 of the least objective, or nothing if that isn't reached: no X satisfies the rows, or the
/// rows leave X >= lower no interior. Mean weight and lower bound must be given. Primal-dual, predictor and corrector
/// after Mehrotra (1992, SIAM J. Optim. 2, 575): some fifteen linear systems over the control points, each with the few
/// entries that samples couple.
std::optional<Eigen::VectorXd> solve_by_interior_point(const FitProgramme& programme, const NormalPattern& pattern);

}  // namespace cloudbow
