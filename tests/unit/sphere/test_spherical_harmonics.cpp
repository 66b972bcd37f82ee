#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "cloudbow/sphere/ordinate_set.hpp"
#include "cloudbow/sphere/spherical_harmonics.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

TEST(SphericalHarmonics, HaveTheirClosedForms) {
  const Direction v = Direction(0.3, -0.5, 0.7).normalized();
  const Eigen::VectorXd y = real_spherical_harmonics(std::vector{v}, 2);
  EXPECT_NEAR(y[harmonic_index(0, 0)], std::sqrt(1 / (4 * pi)), 1e-15);
  EXPECT_NEAR(y[harmonic_index(1, 0)], std::sqrt(3 / (4 * pi)) * v.z(), 1e-15);
  EXPECT_NEAR(y[harmonic_index(1, 1)], std::sqrt(3 / (4 * pi)) * v.x(), 1e-15);
  EXPECT_NEAR(y[harmonic_index(1, -1)], std::sqrt(3 / (4 * pi)) * v.y(), 1e-15);
  EXPECT_NEAR(y[harmonic_index(2, 0)], std::sqrt(5 / (16 * pi)) * (3 * v.z() * v.z() - 1), 1e-15);
  EXPECT_NEAR(y[harmonic_index(2, 2)], std::sqrt(15 / (16 * pi)) * (v.x() * v.x() - v.y() * v.y()), 1e-15);
  EXPECT_NEAR(y[harmonic_index(2, -1)], std::sqrt(15 / (4 * pi)) * v.y() * v.z(), 1e-15);
}

TEST(SphericalHarmonics, AreOrthonormal) {
  const int degree = 8;
  const OrdinateSet set = make_ordinate_set("double-gauss-18x36");  // exact to degree 17 > 8 + 8
  const Eigen::MatrixXd y = real_spherical_harmonics(set.direction, degree);
  const Eigen::Map<const Eigen::VectorXd> weight(set.weight.data(), set.size());
  const Eigen::MatrixXd gram = y * weight.asDiagonal() * y.transpose();
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(SphericalHarmonics, ObeyTheAdditionTheoremThePolesIncluded) {
  const int degree = 40;
  const std::vector<Direction> directions = {
      {0, 0, 1}, {0, 0, -1}, {1, 0, 0}, Direction(1, 1e-9, 1e-7).normalized(), Direction(-0.2, 0.4, 0.9).normalized()};
  const Eigen::MatrixXd y = real_spherical_harmonics(directions, degree);
  for (int i = 0; i < y.cols(); ++i) {
    for (int j = 0; j < y.cols(); ++j) {
      const double cosine = std::clamp(directions[i].dot(directions[j]), -1.0, 1.0);
      for (int l = 0; l <= degree; ++l) {
        const auto first = harmonic_index(l, -l), count = 2 * l + 1;
        EXPECT_NEAR(y.col(i).segment(first, count).dot(y.col(j).segment(first, count)),
                    count / (4 * pi) * std::legendre(l, cosine), 1e-12);  // 81 products of size up to 3
      }
    }
  }
}

}  // namespace
}  // namespace cloudbow
