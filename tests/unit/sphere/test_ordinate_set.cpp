#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "cloudbow/core/error.hpp"
#include "cloudbow/sphere/icosphere.hpp"
#include "cloudbow/sphere/ordinate_set.hpp"
#include "cloudbow/sphere/spherical_harmonics.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

struct Known {
  const char* name;
  int size;
  int exactness_degree;
};
void PrintTo(const Known& known, std::ostream* out) { *out << known.name; }

class EverySet : public testing::TestWithParam<Known> {};
INSTANTIATE_TEST_SUITE_P(OrdinateSet, EverySet,
                         testing::Values(Known{"double-gauss-2x4", 8, 1}, Known{"double-gauss-6x8", 48, 5},
                                         Known{"double-gauss-8x16", 128, 7}, Known{"double-gauss-10x16", 160, 9},
                                         Known{"reduced-double-gauss-12x20", 192, 7},
                                         Known{"double-gauss-18x36", 648, 17}, Known{"control-points-42", 42, 9},
                                         Known{"control-points-162", 162, 15}, Known{"control-points-642", 642, 27}));

TEST_P(EverySet, IsAQuadratureWithDownwardOrdinatesFirst) {
  const OrdinateSet set = make_ordinate_set(GetParam().name);
  EXPECT_EQ(set.name, GetParam().name);
  ASSERT_EQ(set.size(), GetParam().size);
  EXPECT_EQ(set.exactness_degree, GetParam().exactness_degree);
  EXPECT_NEAR(std::accumulate(set.weight.begin(), set.weight.end(), 0.0), 4 * pi, 1e-12);
  for (int d = 0; d < set.size(); ++d) {
    EXPECT_NEAR(set.direction[d].norm(), 1, 1e-15);
    EXPECT_GT(set.weight[d], 0);
    EXPECT_GT(std::abs(set.direction[d].z()), 1e-3);
    EXPECT_EQ(set.direction[d].z() < 0, d < set.size() / 2);  // all are symmetric about the horizon
  }
}

TEST_P(EverySet, IsMappedOntoItselfByItsSymmetry) {
  const OrdinateSet set = make_ordinate_set(GetParam().name);
  EXPECT_EQ(set.symmetry.size(), set.is_control_points ? 120u : 8u);
  for (const auto& map : set.symmetry) {
    EXPECT_LT((map * map.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    for (int d = 0; d < std::min(set.size(), 60); ++d) {
      const Direction image = map * set.direction[d];
      bool found = false;
      for (int e = 0; e < set.size(); ++e) {
        found = found || ((set.direction[e] - image).norm() < 1e-13 && std::abs(set.weight[e] - set.weight[d]) < 1e-13);
      }
      EXPECT_TRUE(found);
    }
  }
}

TEST(OrdinateSet, DoubleGaussHasExactHalfRangeFluxes) {
  for (const char* name : {"double-gauss-2x4", "double-gauss-8x16", "reduced-double-gauss-12x20"}) {
    const OrdinateSet set = make_ordinate_set(name);
    double flux = 0;
    for (int d = 0; d < set.size(); ++d) flux += set.weight[d] * std::max(0.0, set.direction[d].z());
    EXPECT_NEAR(flux, pi, 1e-14);
  }
}

TEST(OrdinateSet, TurnedControlPointsHaveNearlyExactHalfRangeFluxes) {
  const OrdinateSet set = make_ordinate_set("control-points-162");
  double flux = 0;
  for (int d = 0; d < set.size(); ++d) flux += set.weight[d] * std::max(0.0, set.direction[d].z());
  EXPECT_NEAR(flux, pi, 1e-3 * pi);  // .7 % in the textbook orientation, which the rotation is there to avoid
}

TEST(OrdinateSet, ControlPointWeightsAreThePublishedOnes) {
  const std::map<std::string, std::map<double, int>> published = {
      {"control-points-42", {{0.8333333333, 12}, {1.0666666667, 30}}},
      {"control-points-162", {{1.0506983819, 12}, {0.9764237666, 30}, {0.8631429493, 60}, {1.1385054911, 60}}}};
  for (const auto& [name, orbits] : published) {
    const OrdinateSet set = make_ordinate_set(name);
    for (const auto& [weight, count] : orbits) {
      int found = 0;
      for (const double w : set.weight)
        found += std::abs(w * set.size() / (4 * pi) - weight) < 1e-10;  // its last digit
      EXPECT_EQ(found, count) << name << ' ' << weight;
    }
  }
}

TEST(IcosphereWeights, AreExactToTheirDegreeAndNoFurther) {
  const int degree[] = {5, 9, 15, 27};
  for (int subdivisions = 0; subdivisions <= 3; ++subdivisions) {
    const std::vector<double> weight = icosphere_weights(subdivisions);
    const Eigen::MatrixXd harmonics =
        real_spherical_harmonics(make_icosphere(subdivisions).vertex, degree[subdivisions] + 1);
    Eigen::VectorXd integral = harmonics * Eigen::Map<const Eigen::VectorXd>(weight.data(), weight.size());
    integral[0] -= std::sqrt(4 * pi);  // of Y_00
    const int exact = harmonic_count(degree[subdivisions]);
    EXPECT_LT(integral.head(exact).cwiseAbs().maxCoeff(), 1e-12);  // rounding of 642 terms of .02 to 1
    EXPECT_GT(integral.tail(integral.size() - exact).cwiseAbs().maxCoeff(), 1e-3);
    EXPECT_GT(*std::min_element(weight.begin(), weight.end()), 0);
  }
}

TEST(OrdinateSet, RejectsOtherNames) {
  for (const char* name : {"", "gauss-8x16", "double-gauss-7x16", "double-gauss-8x15", "double-gauss-8",
                           "double-gauss-0x4", "double-gauss-8x16x2", "double-gauss-99999999999x4",
                           "reduced-double-gauss-12x-20", "control-points-12", "control-points-100"}) {
    EXPECT_THROW(
        try { make_ordinate_set(name); } catch (const InputError& e) {
          EXPECT_THAT(e.what(),
                      testing::AllOf(testing::HasSubstr(std::string("\"") + name + '"'),
                                     testing::HasSubstr("double-gauss-NxK"), testing::HasSubstr("control-points-M")));
          throw;
        },
        InputError)
        << name;
  }
}

}  // namespace
}  // namespace cloudbow
