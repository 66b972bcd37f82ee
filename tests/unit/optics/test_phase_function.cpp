#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/legendre_series.hpp"
#include "cloudbow/optics/phase_function.hpp"
#include "cloudbow/optics/phase_table.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"
#include "phase_test_tools.hpp"

namespace cloudbow {
namespace {

TEST(PhaseFunction, HenyeyGreensteinHasMeanOneAndMomentsOfItsParameter) {
  for (const double g : {-0.9, -0.3, 0.0, 0.5, 0.85, 0.95}) {
    const auto phase = PhaseFunction::henyey_greenstein(g);
    EXPECT_EQ(phase.asymmetry_parameter(), g);
    for (const int l : {0, 1, 2, 7, 30}) {
      EXPECT_NEAR(phase.moment(l), std::pow(g, l), 1e-16);
      EXPECT_NEAR(integrated_moment(phase, l), std::pow(g, l),
                  2e-9);  // 400 nodes at g = .95: .95^800 = 2e-18, rounding
    }
    EXPECT_NEAR(phase(1), (1 + g) / ((1 - g) * (1 - g)), 1e-12 * phase(1));
    EXPECT_NEAR(phase(-1), (1 - g) / ((1 + g) * (1 + g)), 1e-12 * phase(-1));
  }
}

TEST(PhaseFunction, HenyeyGreensteinIsAccurateInItsPeak) {
  const double g = 1 - 1e-9;
  const auto phase = PhaseFunction::henyey_greenstein(g);
  const double closed_form = (1 + g) / ((1 - g) * (1 - g));
  EXPECT_NEAR(phase(1) / closed_form, 1, 1e-12);
  EXPECT_NEAR(phase.moment(100000), std::pow(g, 100000), 1e-15);
}

TEST(PhaseFunction, PositiveAsymmetryScattersForward) {
  EXPECT_GT(PhaseFunction::henyey_greenstein(0.5)(1), PhaseFunction::henyey_greenstein(0.5)(-1));
  EXPECT_GT(PhaseFunction::double_henyey_greenstein(0.8, -0.3, 0.9)(1), 10);
}

TEST(PhaseFunction, RayleighAndIsotropicHaveTheirClosedForms) {
  const auto rayleigh = PhaseFunction::rayleigh();
  EXPECT_DOUBLE_EQ(rayleigh(1), 1.5);
  EXPECT_DOUBLE_EQ(rayleigh(0), 0.75);
  for (int l = 0; l <= 5; ++l) EXPECT_NEAR(integrated_moment(rayleigh, l), rayleigh.moment(l), 1e-14);
  EXPECT_EQ(PhaseFunction::isotropic()(0.3), 1);
  EXPECT_TRUE(PhaseFunction::isotropic().is_isotropic());
  EXPECT_TRUE(PhaseFunction::henyey_greenstein(0).is_isotropic());
  EXPECT_FALSE(rayleigh.is_isotropic());
}

TEST(PhaseFunction, DoubleHenyeyGreensteinIsTheMixture) {
  const auto mixed = PhaseFunction::double_henyey_greenstein(0.8, -0.4, 0.7);
  const auto forward = PhaseFunction::henyey_greenstein(0.8), backward = PhaseFunction::henyey_greenstein(-0.4);
  for (const double mu : {-1.0, -0.2, 0.5, 1.0}) EXPECT_DOUBLE_EQ(mixed(mu), 0.7 * forward(mu) + 0.3 * backward(mu));
  for (const int l : {0, 1, 2, 9, 500})
    EXPECT_NEAR(mixed.moment(l), 0.7 * std::pow(0.8, l) + 0.3 * std::pow(-0.4, l), 1e-16);
}

TEST(PhaseFunction, LegendreSumIsTheFunctionOfItsMoments) {
  std::vector<double> moments;
  for (int l = 0; l < 200; ++l) moments.push_back(std::pow(0.85, l));
  const auto sum = PhaseFunction::legendre(moments);
  const auto exact = PhaseFunction::henyey_greenstein(0.85);
  // the remainder: sum over l >= 200 of (2l+1) .85^l < 1e-10
  for (const double mu : {-1.0, -0.6, 0.0, 0.9, 1.0}) EXPECT_NEAR(sum(mu), exact(mu), 1e-10);
  EXPECT_EQ(sum.moment(200), 0);
  EXPECT_DOUBLE_EQ(sum.moment(7), std::pow(0.85, 7));
}

TEST(PhaseFunction, KeyTellsFunctionsApart) {
  EXPECT_NE(PhaseFunction::henyey_greenstein(0.85).key(),
            PhaseFunction::henyey_greenstein(std::nextafter(0.85, 1)).key());
  EXPECT_NE(PhaseFunction::legendre({1, 0.5}).key(), PhaseFunction::legendre({1, 0.5, 0.1}).key());
  EXPECT_EQ(PhaseFunction::henyey_greenstein(0.85).key(), PhaseFunction::henyey_greenstein(0.85).key());
}

TEST(PhaseFunction, RejectsWhatIsNoPhaseFunction) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_rejected([] { PhaseFunction::henyey_greenstein(1); }, "1", "-1 < g < 1");
  expect_rejected([] { PhaseFunction::henyey_greenstein(-1); }, "-1", "-1 < g < 1");
  expect_rejected([=] { PhaseFunction::henyey_greenstein(nan); }, "nan", "-1 < g < 1");
  expect_rejected([] { PhaseFunction::double_henyey_greenstein(0.8, -0.2, 1.1); }, "1.1", "0 to 1");
  expect_rejected([] { PhaseFunction::legendre({}); }, "missing", "1");
  expect_rejected([] { PhaseFunction::legendre({3, 0.5}); }, "3", "1");
  expect_rejected([] { PhaseFunction::legendre({1, 0.5, -1.2}); }, "-1.2", "-1 to 1");
  expect_rejected([=] { PhaseFunction::legendre({1, nan}); }, "nan", "-1 to 1");
  const auto table = [](std::vector<double> angle, std::vector<double> value) { PhaseFunction::table(angle, value); };
  expect_rejected([&] { table({0, 90}, {1, 1}); }, "90", "0 to 180");
  expect_rejected([&] { table({1, 180}, {1, 1}); }, "1 to 180", "0 to 180");
  expect_rejected([&] { table({0, 90, 80, 180}, {1, 1, 1, 1}); }, "90", "ascending");
  expect_rejected([&] { table({0, 90, 90, 180}, {1, 1, 1, 1}); }, "90", "ascending");
  expect_rejected([&] { table({0, 90, 180}, {1, -0.1, 1}); }, "-0.1", ">= 0");
  expect_rejected([&] { table({0, 90, 180}, {1, nan, 1}); }, "nan", ">= 0");
  expect_rejected([&] { table({0, 180}, {0, 0}); }, "0", "positive mean");
  expect_rejected([&] { table({0, 180}, {1}); }, "2 angles and 1 values", "as many");
}

}  // namespace
}  // namespace cloudbow
