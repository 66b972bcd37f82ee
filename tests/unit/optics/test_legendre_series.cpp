// Sums of Legendre polynomials. Truth: closed forms of their least values.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/legendre_series.hpp"
#include "cloudbow/optics/phase_function.hpp"
#include "cloudbow/optics/phase_table.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"
#include "phase_test_tools.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

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

}  // namespace
}  // namespace cloudbow
