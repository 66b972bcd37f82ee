// Slopes of light within a cell from the first moments that its rays leave there (docs/theory.md, Eqs. 20d, 20e).
#pragma once

#include <Eigen/Core>

#include "transport/rays/path_pattern.hpp"

namespace cloudbow {

/// Mean of r r^T over the segments that `step` crosses, r the place in cell sizes: the first moment of light of slope g
/// is this times g.
Eigen::Matrix3d spread_of_places(const PathPattern& pattern, int step);

/// The inverse for such a symmetric matrix, the sum or mean over directions. Axes along which its directions hardly
/// spread get a slope of 0: an eigenvalue v has the inverse v / (v^2 + e^2), e = 2e-3.
/// @param scale what the matrix is a sum over: its e is e times this.
Eigen::Matrix3d regular_inverse(const Eigen::Matrix3d& spread, double scale = 1);

}  // namespace cloudbow
