// One ray in one cell. Truth: the formal solution of dI/dt = S - I with S linear in t, in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "transport/rays/crossing.hpp"

namespace cloudbow {
namespace {

constexpr double in = 1.7;
constexpr double entry = .4;
constexpr double exit_source = 2.3;

// I(t') = S(t') - s + (I_in - S(0) + s) e^-t' with slope s = (S2 - S1)/t.
double leaving(double t) {
  const double slope = (exit_source - entry) / t;
  return exit_source - slope + (in - entry + slope) * std::exp(-t);
}
// Its mean over 0 to t.
double mean(double t) {
  const double slope = (exit_source - entry) / t;
  return .5 * (entry + exit_source) - slope + (in - entry + slope) * -std::expm1(-t) / t;
}

TEST(Crossing, LinearSourceHasTheClosedForm) {
  for (const double t : {.05, .69, .71, 3., 40., 1e4}) {
    const Crossing<double> crossing(t);
    // The closed form loses 1/t^2 of its digits; the function compared with it loses 1/t.
    EXPECT_NEAR(crossing.leaving(in, crossing.emitted(entry, exit_source)), leaving(t), 1e-12) << t;
    EXPECT_NEAR(crossing.mean(in, entry, exit_source), mean(t), 1e-12) << t;
    EXPECT_NEAR(crossing.absorbed(), -std::expm1(-t), 1e-15) << t;
  }
}

TEST(Crossing, FirstMomentIsTheIntegralOfPlaceTimesRadiance) {
  for (const double t : {.05, .69, .71, 3., 40.}) {
    const Crossing<double> crossing(t);
    // Midpoint rule over s in [0, 1], of I after the path s t: error (1/n)^2 t^2.
    constexpr int n = 200000;
    const double slope = (exit_source - entry) / t;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      const double s = (i + .5) / n;
      sum += s * (entry + slope * t * s - slope + (in - entry + slope) * std::exp(-t * s)) / n;
    }
    EXPECT_NEAR(crossing.first_moment(in, entry, exit_source), sum, 1e-7) << t;
  }
}

TEST(Crossing, ConstantSourceIsTheLinearOneWithoutASlope) {
  for (const double t : {0., 1e-9, .05, .71, 3., 1e4}) {
    const Crossing<double> crossing(t);
    // Rounding of sums of a few terms of order 1.
    EXPECT_NEAR(crossing.leaving_constant(in, entry), crossing.leaving(in, crossing.emitted(entry, entry)), 1e-15);
    EXPECT_NEAR(crossing.mean_constant(in, entry), crossing.mean(in, entry, entry), 1e-15);
  }
}

TEST(Crossing, WhatEntersAndIsSentLeavesOrStays) {
  // I_in - I_out + t (S_mean - I_mean) = 0 whatever the error of the functions: to rounding of float.
  for (const float t : {0.F, 1e-4F, .3F, 7.F, 5e6F}) {
    const Crossing<float> crossing(t);
    const auto in_float = static_cast<float>(in), s1 = static_cast<float>(entry), s2 = static_cast<float>(exit_source);
    const float out = crossing.leaving(in_float, crossing.emitted(s1, s2));
    const float held = crossing.mean(in_float, s1, s2);
    const double size = in + static_cast<double>(t);
    EXPECT_NEAR(in - static_cast<double>(out) +
                    static_cast<double>(t) * (.5 * (entry + exit_source) - static_cast<double>(held)),
                0, 4 * size * static_cast<double>(std::numeric_limits<float>::epsilon()))
        << t;
    EXPECT_GE(out, 0);
    EXPECT_GE(held, 0);
  }
}

TEST(Crossing, LanesAreRaysByThemselves) {
  Lanes<float> extinction{}, light{};
  for (int i = 0; i < lanes; ++i) {
    extinction[i] = std::pow(10.F, static_cast<float>(i) - 3);
    light[i] = static_cast<float>(i);
  }
  const Crossing<Lanes<float>> together(optical_path(extinction, 2.F));
  const Lanes<float> source = light * 0 + .5F;
  const Lanes<float> out = together.leaving(light, together.emitted(source, source + 1));
  for (int i = 0; i < lanes; ++i) {
    const Crossing<float> alone(optical_path(static_cast<float>(extinction[i]), 2.F));
    const float truth = alone.leaving(static_cast<float>(i), alone.emitted(.5F, 1.5F));
    EXPECT_NEAR(out[i], truth, 1e-6 * (1 + truth));  // the compiler may fuse other products
  }
}

TEST(Crossing, OpticalPathIsHeldInItsRange) {
  EXPECT_EQ(optical_path(2.F, 3.F), 6.F);
  EXPECT_EQ(optical_path(1e30F, 1e30F), largest_optical_path);
  EXPECT_EQ(optical_path(1e30, 1e30), static_cast<double>(largest_optical_path));
  const Lanes<float> path = optical_path(Lanes<float>{} + 1e6F, 7.F);
  EXPECT_EQ(path[3], largest_optical_path);
}

}  // namespace
}  // namespace cloudbow
