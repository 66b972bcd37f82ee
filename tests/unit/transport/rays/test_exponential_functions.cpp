#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "transport/rays/exponential_functions.hpp"

namespace cloudbow {
namespace {

std::vector<double> optical_paths(double first, double last) {
  std::vector<double> paths;
  for (double t = first; t <= last; t *= 1.01) paths.push_back(t);
  return paths;
}

// Truth: phi_k(t) = sum_n (-t)^n / (n + k)! if that converges fast, the closed forms if they do not cancel, both in
// long double.
ExponentialFunctions<long double> exact(long double t) {
  if (t < 1) {
    const auto series = [t](int k) {
      long double term = 1;
      for (int i = 2; i <= k; ++i) term /= i;
      long double sum = 0;
      for (int n = 0; n < 30; ++n) {
        sum += term;
        term *= -t / static_cast<long double>(n + k + 1);
      }
      return sum;
    };
    return {series(1), series(2), series(3), series(4)};
  }
  const long double phi1 = -std::expm1(-t) / t;
  const long double phi2 = (1 - phi1) / t;
  const long double phi3 = (.5L - phi2) / t;
  return {phi1, phi2, phi3, (1 / 6.L - phi3) / t};
}

TEST(ExponentialFunctions, DoubleIsExactToRounding) {
  // The closed forms lose a factor 1/(1 - phi1) and 1/(1/2 - phi2) of digits: ten at t = .7, from which they are used.
  // phi4 loses another factor 1/(1/6 - phi3).
  constexpr double tolerance = 20 * std::numeric_limits<double>::epsilon();
  for (const double t : optical_paths(1e-9, 2e4)) {
    const auto phi = exponential_functions(t);
    const auto truth = exact(t);
    EXPECT_NEAR(phi.phi1 / static_cast<double>(truth.phi1), 1, tolerance) << t;
    EXPECT_NEAR(phi.phi2 / static_cast<double>(truth.phi2), 1, tolerance) << t;
    EXPECT_NEAR(phi.phi3 / static_cast<double>(truth.phi3), 1, tolerance) << t;
    EXPECT_NEAR(phi.phi4 / static_cast<double>(truth.phi4), 1, 10 * tolerance) << t;
  }
}

TEST(ExponentialFunctions, FloatFollowsTheClosedForms) {
  // Bounds measured for the rational fit; float adds the rounding of two polynomials and a quotient. Because the three
  // share a denominator, phi2 and phi3 are off by phi1's error over t and t^2: t times either, which is how they enter
  // radiances, is never off by more than 3e-6.
  std::array<double, 4> relative{};
  std::array<double, 3> in_radiances{};
  for (const double t : optical_paths(1e-9, 2e4)) {
    const float x = static_cast<float>(t);
    const auto phi = exponential_functions(x);
    const auto truth = exact(x);
    const std::array<double, 3> off{static_cast<double>(phi.phi1 - truth.phi1),
                                    static_cast<double>(phi.phi2 - truth.phi2),
                                    static_cast<double>(phi.phi3 - truth.phi3)};
    relative[3] = std::max(relative[3], std::abs(static_cast<double>(phi.phi4 / truth.phi4 - 1)));
    const std::array<double, 3> size{static_cast<double>(truth.phi1), static_cast<double>(truth.phi2),
                                     static_cast<double>(truth.phi3)};
    for (std::size_t k = 0; k < 3; ++k) {
      relative[k] = std::max(relative[k], std::abs(off[k] / size[k]));
      in_radiances[k] = std::max(in_radiances[k], std::abs(off[k]) * (k == 0 ? 1 : t));
    }
  }
  EXPECT_LT(relative[0], 2.5e-6);
  EXPECT_LT(relative[1], 7e-6);
  EXPECT_LT(relative[2], 5e-5);
  EXPECT_LT(relative[3], 2e-3);  // which slopes of light depend on, but not energy
  for (const double e : in_radiances) EXPECT_LT(e, 3e-6);
}

template <class Real>
class ExponentialFunctionsOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(ExponentialFunctionsOf, Precisions);

TYPED_TEST(ExponentialFunctionsOf, ConserveLightWhateverTheErrorOfTheFit) {
  // phi1 + t phi2 = 1: incident light stays or leaves. 1/2 - t phi3 = phi2: so does emitted light. Both hold in the
  // coefficients themselves, so the rest is a few roundings.
  constexpr double tolerance = 6 * static_cast<double>(std::numeric_limits<TypeParam>::epsilon());
  for (const double path : optical_paths(1e-9, 2e4)) {
    const auto t = static_cast<TypeParam>(path);
    const auto phi = exponential_functions(t);
    EXPECT_NEAR(static_cast<double>(phi.phi1) + static_cast<double>(t) * static_cast<double>(phi.phi2), 1, tolerance)
        << t;
    EXPECT_NEAR(static_cast<double>(phi.phi2) + static_cast<double>(t) * static_cast<double>(phi.phi3), .5, tolerance)
        << t;
  }
}

TYPED_TEST(ExponentialFunctionsOf, KeepRadiancesPositive) {
  // The weights of light that enters, of the source at the ray's entry and of that at its exit.
  for (const double path : optical_paths(1e-9, 1e6)) {
    const auto t = static_cast<TypeParam>(path);
    const auto phi = exponential_functions(t);
    EXPECT_GT(phi.phi1, 0) << t;
    EXPECT_GT(phi.phi3, 0) << t;
    EXPECT_GE(phi.phi1, phi.phi2) << t;
    EXPECT_GE(phi.phi2, phi.phi3) << t;
  }
}

TYPED_TEST(ExponentialFunctionsOf, StartAtTheirLimits) {
  const auto phi = exponential_functions(TypeParam(0));
  EXPECT_EQ(phi.phi1, TypeParam(1));
  EXPECT_EQ(phi.phi2, TypeParam(.5));
  EXPECT_FLOAT_EQ(static_cast<float>(phi.phi3), 1.F / 6);
}

TEST(Transmission, FloatFollowsTheExponential) {
  // Degree 7 on +-ln 2 / 2 leaves 5e-9; the difference is two roundings of the last steps of the polynomial.
  double worst = 0;
  const auto check = [&worst](float x) {
    worst = std::max(worst, std::abs(static_cast<double>(transmission(x)) / std::exp(-static_cast<double>(x)) - 1));
  };
  for (float x = 0; x < 87.F; x += 0.00390625F) check(x);
  for (const double x : optical_paths(1e-9, 87.)) check(static_cast<float>(x));
  EXPECT_LT(worst, 1e-7);
}

TEST(Transmission, FloatStaysPositiveAndTinyBeyondItsRange) {
  EXPECT_EQ(transmission(0.F), 1.F);
  for (const float x : {87.4F, 100.F, 1e4F, 1e30F, std::numeric_limits<float>::max()}) {
    EXPECT_GT(transmission(x), 0.F) << x;
    EXPECT_LT(transmission(x), 3e-38F) << x;
  }
}

}  // namespace
}  // namespace cloudbow
