#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cloudbow/sphere/harmonic_series.hpp"
#include "cloudbow/sphere/icosphere.hpp"
#include "directions.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

double cubic(const Direction& v) { return 1 + v.x() * v.y() * v.z() - 2 * v.z() * v.z() + v.x(); }

TEST(HarmonicSeries, HoldsAPolynomialOfItsDegreeExactly) {
  const HarmonicSeries f(3, make_ordinate_set("double-gauss-8x16"), cubic);  // exact to degree 7 > 3 + 3
  EXPECT_NEAR(f.coefficients()[0], std::sqrt(4 * pi) * (1 - 2.0 / 3), 1e-14);
  for (const Direction& d : random_directions(100)) EXPECT_NEAR(f(d), cubic(d), 1e-13);
}

TEST(HarmonicSeries, IsScaledAndAddedCoefficientByCoefficient) {
  const OrdinateSet set = make_ordinate_set("double-gauss-8x16");
  HarmonicSeries sum(3, set, [](const Direction& v) { return v.y(); });
  sum *= -2;
  sum += HarmonicSeries(3, set, cubic);
  for (const Direction& d : random_directions(50)) EXPECT_NEAR(sum(d), cubic(d) - 2 * d.y(), 1e-13);
}

TEST(HarmonicSeries, QueriesManyFunctionsLikeItselfAlone) {
  for (const int degree : {2, 5, 12}) {  // 9, 36, 169 harmonics: with and without a rest of four
    const int functions = 5000, count = harmonic_count(degree);
    std::vector<float> coefficients(count * functions), result(functions);
    for (int i = 0; i < count * functions; ++i) coefficients[i] = std::cos(0.37f * static_cast<float>(i));
    std::vector<double> basis(count);
    HarmonicBasis(degree).evaluate(Direction(0.3, -0.2, -0.8).normalized(), basis);
    query_harmonics<float>(basis, coefficients, result);
    for (int n = 0; n < functions; n += 7) {
      double expected = 0;
      for (int k = 0; k < count; ++k) expected += basis[k] * coefficients[k * functions + n];
      EXPECT_NEAR(result[n], expected, count * 1e-6);  // as many roundings of float
    }
  }
}

TEST(HarmonicRotation, TurnsEveryHarmonicLikeItsArgument) {
  const int degree = 20;
  const auto directions = random_directions(30);
  for (const auto& rotation : {turn(0.7, {1, 2, -1}), turn(pi, {0, 0, 1}), turn(pi / 2, {0, 1, 0}),
                               turn(1e-9, {1, 0, 0}), Eigen::Matrix3d(Eigen::Matrix3d::Identity())}) {
    const HarmonicRotation turned(rotation, degree);
    std::vector<Direction> back;
    for (const Direction& d : directions) back.push_back(rotation.transpose() * d);
    const Eigen::MatrixXd here = real_spherical_harmonics(directions, degree),
                          there = real_spherical_harmonics(back, degree);
    for (int l = 0; l <= degree; ++l) {
      const int first = harmonic_index(l, -l), count = 2 * l + 1;
      // The rotated Y_lm, as a sum of the others, at d is Y_lm at R^T d. Rounding grows by some bits over 20 steps.
      const Eigen::MatrixXd difference =
          turned.block(l).transpose() * here.middleRows(first, count) - there.middleRows(first, count);
      EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-12) << l;
    }
  }
}

TEST(HarmonicRotation, IsOrthogonalAndFollowsTheProductOfRotations) {
  const Eigen::Matrix3d a = turn(0.7, {1, 2, -1}), b = turn(-1.9, {0.3, 0, 1});
  const HarmonicRotation ra(a, 12), rb(b, 12), both(a * b, 12);
  for (int l = 0; l <= 12; ++l) {
    EXPECT_LT((ra.block(l) * ra.block(l).transpose() - Eigen::MatrixXd::Identity(2 * l + 1, 2 * l + 1)).norm(), 1e-12);
    EXPECT_LT((ra.block(l) * rb.block(l) - both.block(l)).norm(), 1e-12);
  }
}

TEST(HarmonicRotation, TurnsAFunctionInTheSenseOfTheRotation) {
  const Eigen::Matrix3d rotation = turn(0.9, {1, -1, 2});
  const HarmonicSeries f(3, make_ordinate_set("double-gauss-8x16"), cubic);
  const HarmonicSeries g = f.rotated(HarmonicRotation(rotation, 3));
  for (const Direction& d : random_directions(50)) EXPECT_NEAR(g(rotation * d), cubic(d), 1e-13);
}

TEST(HarmonicRotation, TurnsManyFunctionsLikeOne) {
  const HarmonicRotation rotation(turn(0.9, {1, -1, 2}), 2);
  const int functions = 4;
  std::vector<double> coefficients(9 * functions), rotated(coefficients.size());
  for (int i = 0; i < 9 * functions; ++i) coefficients[i] = std::sin(1.0 + i);
  rotation.apply<double>(coefficients, rotated);
  for (int n = 0; n < functions; ++n) {
    std::vector<double> one, expected(9);
    for (int k = 0; k < 9; ++k) one.push_back(coefficients[k * functions + n]);
    rotation.apply<double>(one, expected);
    for (int k = 0; k < 9; ++k) EXPECT_NEAR(rotated[k * functions + n], expected[k], 1e-15);
  }
}

}  // namespace
}  // namespace cloudbow
