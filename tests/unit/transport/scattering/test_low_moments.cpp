// Moments of radiance at the ordinates. Truth: polynomials of degree 2, which the quadrature integrates exactly.
#include <gtest/gtest.h>

#include <numbers>

#include "transport/scattering/low_moments.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

TEST(LowMoments, OfEvenRadianceAreItsIntegralAlone) {
  const OrdinateSet ordinates = make_ordinate_set("double-gauss-8x16");
  const LowMoments<double> low(ordinates);
  const Eigen::VectorXd moments = low.weights * Eigen::VectorXd::Ones(ordinates.size());
  EXPECT_NEAR(moments[0], 4 * pi, 1e-12);
  EXPECT_LT(moments.tail(low_moments - 1).cwiseAbs().maxCoeff(), 1e-12);
}

// Radiance 3 z in the basis 1, sqrt(3) (x, y, z): 4 pi sqrt(3) in the fourth place.
TEST(LowMoments, OfRadianceAlongAnAxisAreThatComponent) {
  const OrdinateSet ordinates = make_ordinate_set("double-gauss-8x16");
  const LowMoments<double> low(ordinates);
  Eigen::VectorXd radiance(ordinates.size());
  for (int d = 0; d < ordinates.size(); ++d) radiance[d] = 3 * ordinates.direction[d].z();
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(low_moments);
  expected[3] = 4 * pi * std::sqrt(3.);
  EXPECT_LT((low.weights * radiance - expected).cwiseAbs().maxCoeff(), 1e-12);
}

// The basis is orthonormal up to 4 pi: the same holds for the light of all ordinates, each as a beam.
TEST(LowMoments, OfBeamsSumToThoseOfTheRadiance) {
  const OrdinateSet ordinates = make_ordinate_set("double-gauss-8x16");
  const LowMoments<double> low(ordinates);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(low_moments);
  for (int d = 0; d < ordinates.size(); ++d) {
    const LowMomentValues beam = low_moments_along(ordinates.direction[d]);
    const double radiance = 1 + 3 * ordinates.direction[d].x();
    for (int m = 0; m < low_moments; ++m) sum[m] += ordinates.weight[d] * radiance * beam[static_cast<std::size_t>(m)];
  }
  EXPECT_NEAR(sum[0], 4 * pi, 1e-12);
  EXPECT_NEAR(sum[1], 4 * pi * std::sqrt(3.), 1e-12);
  EXPECT_LT(sum.tail(low_moments - 2).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(LowMoments, AnAdditionOfOneMomentChangesThatMomentAlone) {
  for (const char* name : {"double-gauss-4x8", "double-gauss-8x16", "reduced-double-gauss-10x16"}) {
    const LowMoments<double> low(make_ordinate_set(name));
    const Eigen::MatrixXd product = low.weights * low.shape;
    EXPECT_LT((product - Eigen::MatrixXd::Identity(low_moments, low_moments)).cwiseAbs().maxCoeff(), 1e-12) << name;
  }
}

}  // namespace
}  // namespace cloudbow
