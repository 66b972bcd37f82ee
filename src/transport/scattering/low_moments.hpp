// The moments l <= 2 of radiance at the ordinates, in the basis 1, sqrt(3) (x, y, z), ... that is orthonormal over the
// sphere up to 4 pi. The acceleration works on them.
#pragma once

#include "cloudbow/sphere/ordinate_set.hpp"
#include "transport/scattering/scattering.hpp"

namespace cloudbow {

template <class Real>
struct LowMoments {
  LowMoments() = default;
  explicit LowMoments(const OrdinateSet& ordinates);

  DenseMatrix<Real> weights;  ///< low_moments x D: radiance at the ordinates to moments
  DenseMatrix<Real> shape;    ///< D x low_moments: addition to the radiance per unit of each moment
};

}  // namespace cloudbow
