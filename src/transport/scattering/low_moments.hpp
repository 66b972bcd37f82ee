// The moments l <= 2 of radiance at the ordinates, in the basis 1, sqrt(3) (x, y, z), ... that is orthonormal over the
// sphere up to 4 pi. The acceleration works on them.
#pragma once

#include <array>

#include "cloudbow/sphere/ordinate_set.hpp"
#include "transport/scattering/scattering.hpp"

namespace cloudbow {

using LowMomentValues = std::array<double, low_moments>;

/// The basis in one direction: moments of a unit flux that travels along it.
LowMomentValues low_moments_along(const Direction& travel);

template <class Real>
struct LowMoments {
  LowMoments() = default;
  explicit LowMoments(const OrdinateSet& ordinates);

  DenseMatrix<Real> weights;  ///< low_moments x D: radiance at the ordinates to moments
  DenseMatrix<Real> shape;    ///< D x low_moments: addition to the radiance per unit of each moment
};

}  // namespace cloudbow
