// Real spherical harmonics, orthonormal over the sphere, without the Condon-Shortley phase.
#pragma once

#include <Eigen/Core>
#include <span>

#include "cloudbow/sphere/direction.hpp"

namespace cloudbow {

/// Row of Y_lm, -l <= m <= l, in real_spherical_harmonics().
constexpr int harmonic_index(int l, int m) { return l * (l + 1) + m; }

/// Y_lm of all degrees l <= degree: (degree+1)^2 rows, one column a direction. Y_00 = 1/sqrt(4 pi); m > 0 goes with
/// cos(m azimuth), m < 0 with sin(|m| azimuth). Polynomials in x, y, z: the poles are no special case.
Eigen::MatrixXd real_spherical_harmonics(std::span<const Direction> directions, int degree);

}  // namespace cloudbow
