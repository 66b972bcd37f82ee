#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/legendre_series.hpp"
#include "cloudbow/optics/phase_function.hpp"
#include "cloudbow/optics/phase_table.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

/// (1/2) int P P_l dmu
double integrated_moment(const PhaseFunction& phase, int l, int nodes = 400) {
  const GaussLegendre rule = make_gauss_legendre(nodes);
  double sum = 0;
  for (int i = 0; i < nodes; ++i) sum += rule.weight[i] / 2 * phase(rule.node[i]) * std::legendre(l, rule.node[i]);
  return sum;
}

void expect_rejected(const std::function<void()>& make, const std::string& found, const std::string& allowed) {
  try {
    make();
    ADD_FAILURE() << "accepted " << found;
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::AllOf(HasSubstr(found), HasSubstr(allowed)));
  }
}

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

TEST(LegendreSeries, FindsTheLeastValue) {
  // 1 + 2.5 P_2: least at 90 degrees, 1 - 2.5/2; (1 - mu)^2 3/4 = 1 - 3/2 mu + 1/2 P_2: 0 straight on.
  const LeastValue sideways = least_value(std::vector{1., 0., 0.5}), onward = least_value(std::vector{1., -0.5, 0.1});
  EXPECT_NEAR(sideways.value, -0.25, 1e-14);
  EXPECT_NEAR(sideways.angle_deg, 90, 1e-12);
  EXPECT_NEAR(onward.value, 0, 1e-14);
  EXPECT_EQ(onward.angle_deg, 0);
}

std::vector<double> henyey_greenstein_moments(double g, int count) {
  std::vector<double> moments(count);
  for (int l = 0; l < count; ++l) moments[l] = std::pow(g, l);
  return moments;
}

TEST(LegendreSeries, NegativeFunctionsAreRefused) {
  using Moments = std::vector<double>;
  const auto check = [](const Moments& moments) { return [moments] { check_not_negative(moments); }; };
  // Rayleigh's and Henyey and Greenstein's moments times 2l+1, and others that no function has.
  expect_rejected(check({1, 0, 0.5}), "found -0.25 at 90 degrees", "2l+1");
  expect_rejected(check({1, 1, 1, 1}), "negative", ">= 0");
  expect_rejected(check({1, 0.9, 0.45, 0.189, 0.0729, 0.0267, 0.0095, 0.0033}), "at 180 degrees", "more moments");
  expect_rejected(check({1, 0, 0.402}), "-0.005", "2l+1");
  // Cut while the terms are large: the values at the sides swing by more than their size.
  for (const auto& [g, count] : {std::pair{0.85, 8}, {0.85, 32}, {0.9, 48}, {0.95, 100}})
    expect_rejected(check(henyey_greenstein_moments(g, count)), "negative", "more moments");
}

TEST(LegendreSeries, SeriesThatFallOffPass) {
  for (const double g : {-0.95, -0.5, 0.0, 0.3, 0.5, 0.85, 0.95, 0.98}) {
    const int enough = 2 + static_cast<int>(std::log(1e-5) / std::log(std::max(std::abs(g), 0.01)));
    EXPECT_EQ(check_not_negative(henyey_greenstein_moments(g, enough)), "") << g;
  }
  EXPECT_EQ(check_not_negative(PhaseFunction::rayleigh().moments()), "");
  EXPECT_EQ(check_not_negative(std::vector{1.0}), "");
  EXPECT_EQ(check_not_negative(std::vector{1.0, 0.3334}), "");  // 1 + mu, to four decimals
}

// .9^l ends after l = 63 with a term of .17: half of it at 180 degrees, less the function's own .028. With zeros behind
// as well.
TEST(LegendreSeries, RingingOfASeriesThatWasCutIsTold) {
  std::vector<double> moments = henyey_greenstein_moments(0.9, 64);
  EXPECT_THAT(check_not_negative(moments), testing::AllOf(HasSubstr("-0.0518 at 180"), HasSubstr("more moments")));
  moments.resize(100, 0);
  EXPECT_THAT(check_not_negative(moments), HasSubstr("-0.0518 at 180"));
}

TEST(PhaseFunction, TableTellsItsMean) {
  EXPECT_NEAR(make_phase_table(std::vector{0.0, 180.0}, std::vector{3.2, 0.8}).mean(), 2, 1e-15);
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
