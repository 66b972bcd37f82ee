// Phase functions as tables. Truth: closed forms of the functions that the tables are made of.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/legendre_series.hpp"
#include "cloudbow/optics/phase_function.hpp"
#include "cloudbow/optics/phase_table.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"
#include "phase_test_tools.hpp"

namespace cloudbow {
namespace {

TEST(PhaseFunction, TableOfALinearFunctionHasItsMoments) {
  // P = 1 + .6 mu is linear in the cosine: two points say it all.
  const std::vector<double> angle = {0, 180}, value = {3.2, 0.8};
  const auto phase = PhaseFunction::table(angle, value);
  for (const double mu : {-1.0, -0.3, 0.0, 0.8, 1.0}) EXPECT_NEAR(phase(mu), 1 + 0.6 * mu, 1e-15);
  EXPECT_NEAR(phase.moment(1), 0.2, 1e-15);
  for (const int l : {2, 3, 50, 1023}) EXPECT_NEAR(phase.moment(l), 0, 1e-14) << l;
}

TEST(PhaseFunction, TableResolvesANarrowPeak) {
  // A cone that falls linearly in mu from 0 degrees to nothing at .5, P = (mu - m)/c: chi_1 = (1 + (1 + 1 + m)/... in
  // closed form.
  const double m = std::cos(0.5 * std::numbers::pi / 180), w = 1 - m;
  const auto phase = PhaseFunction::table(std::vector{0.0, 0.5, 180.0}, std::vector{1.0, 0.0, 0.0});
  EXPECT_NEAR(phase(1), 4 / w,
              1e-9 * 4 / w);  // mean 1: height times width / 2 = 2; m itself is good to 1e-16 / w = 3e-12
  EXPECT_NEAR(phase.moment(1), 1 - w / 3, 1e-14);  // centroid of a triangle
  // near the pole P_l(mu) = 1 - l(l+1) (1-mu)/2 + (l-1) l (l+1) (l+2) (1-mu)^2 / 16 - ...; means of (1-mu)^k are 2 w^k
  // / ((k+1)(k+2))
  for (const int l : {10, 50}) {
    const double k = l * (l + 1.0), second = (l - 1.0) * l * (l + 1) * (l + 2) / 16;
    const double third = (l - 2.0) * (l - 1) * l * (l + 1) * (l + 2) * (l + 3) / 288;
    EXPECT_NEAR(phase.moment(l), 1 - k / 2 * w / 3 + second * w * w / 6 - third * w * w * w / 10, 1e-6);
  }
  for (const int l : {500, 1000}) EXPECT_LT(std::abs(phase.moment(l)), 1);
}

TEST(PhaseFunction, TableOfHenyeyGreensteinHasItsMoments) {
  std::vector<double> angle, value;
  const auto exact = PhaseFunction::henyey_greenstein(0.85);
  for (int i = 0; i <= 3600; ++i) {
    angle.push_back(i * 0.05);
    value.push_back(5 * exact(std::cos(angle.back() * std::numbers::pi / 180)));  // any factor: it is normalised
  }
  const auto phase = PhaseFunction::table(angle, value);
  // linear interpolation: second derivative in the peak times step^2 / 12
  for (const int l : {1, 2, 10, 30}) EXPECT_NEAR(phase.moment(l), std::pow(0.85, l), 1e-5);
  EXPECT_NEAR(phase(0.3), exact(0.3), 1e-5);
}

TEST(PhaseFunction, TableTellsItsMean) {
  EXPECT_NEAR(make_phase_table(std::vector{0.0, 180.0}, std::vector{3.2, 0.8}).mean(), 2, 1e-15);
}

}  // namespace
}  // namespace cloudbow
