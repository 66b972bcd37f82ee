// Gauss-Legendre quadrature.
#pragma once

#include <vector>

namespace cloudbow {

struct GaussLegendre {
  std::vector<double> node;    ///< ascending in (-1, 1), antisymmetric to the bit
  std::vector<double> weight;  ///< sum 2
};

/// @param count >= 1 nodes; integrates polynomials up to degree 2 count - 1 exactly.
GaussLegendre make_gauss_legendre(int count);

}  // namespace cloudbow
