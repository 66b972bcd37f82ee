#include "transport/scattering/low_moments.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace cloudbow {
namespace {

Eigen::MatrixXd orthonormal_basis(const OrdinateSet& ordinates) {
  Eigen::MatrixXd y(low_moments, ordinates.size());
  for (int d = 0; d < ordinates.size(); ++d) {
    const LowMomentValues values = low_moments_along(ordinates.direction[d]);
    y.col(d) = Eigen::Map<const Eigen::VectorXd>(values.data(), low_moments);
  }
  return y;
}

}  // namespace

LowMomentValues low_moments_along(const Direction& o) {
  const double first = std::sqrt(3.);
  const double second = std::sqrt(15.);
  return {1,
          first * o.x(),
          first * o.y(),
          first * o.z(),
          second * o.x() * o.y(),
          second * o.x() * o.z(),
          second * o.y() * o.z(),
          second / 2 * (o.x() * o.x() - o.y() * o.y()),
          std::sqrt(5.) / 2 * (3 * o.z() * o.z() - 1)};
}

template <class Real>
LowMoments<Real>::LowMoments(const OrdinateSet& ordinates) {
  const Eigen::MatrixXd y = orthonormal_basis(ordinates);
  const Eigen::MatrixXd weighted =
      y * Eigen::Map<const Eigen::VectorXd>(ordinates.weight.data(), ordinates.size()).asDiagonal();
  // A set with few directions may not separate all moments; the pseudoinverse then omits the inseparable ones.
  const Eigen::MatrixXd gram = weighted * y.transpose();
  weights = weighted.template cast<Real>();
  shape = (y.transpose() * gram.completeOrthogonalDecomposition().pseudoInverse()).template cast<Real>();
}

template struct LowMoments<float>;
template struct LowMoments<double>;

}  // namespace cloudbow
