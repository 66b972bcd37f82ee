// Vectors whose length neither overflows nor underflows.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace cloudbow {

/// The vector times the power of two that brings its largest component to 1 to 2. No bit of its direction changes.
inline Eigen::Vector3d scaled_to_order_one(const Eigen::Vector3d& vector) {
  const double largest = vector.cwiseAbs().maxCoeff();
  if (!(largest > 0) || !vector.allFinite()) return vector;
  const int exponent = std::ilogb(largest);
  return vector.unaryExpr([exponent](double x) { return std::scalbn(x, -exponent); });
}

}  // namespace cloudbow
