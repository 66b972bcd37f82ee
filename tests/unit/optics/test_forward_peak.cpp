#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "cloudbow/optics/forward_peak.hpp"

namespace cloudbow {
namespace {

// Mean over the sphere of f(cos) P_l(cos), by the midpoint rule in the angle: to 1e-5 with these functions.
template <class Function>
double moment(const Function& f, int l) {
  constexpr int steps = 20000;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double angle = std::numbers::pi * (i + .5) / steps;
    sum += .5 * std::sin(angle) * f(std::cos(angle)) * std::legendre(l, std::cos(angle));
  }
  return sum * std::numbers::pi / steps;
}

struct Truncations {
  DeltaM fine;
  DeltaM coarse;
};

std::vector<Truncations> truncations() {
  std::vector<Truncations> list;
  for (const double g : {.75, .85, .95}) {
    const PhaseFunction phase = PhaseFunction::henyey_greenstein(g);
    list.push_back({delta_m(phase, 48), delta_m(phase, 12)});
  }
  return list;
}

TEST(ForwardPeak, AndItsRestMakeTheFinerFunction) {
  for (const auto& [fine, coarse] : truncations()) {
    const ForwardPeak peak(fine, coarse);
    EXPECT_NEAR(peak.share(), coarse.forward_fraction - fine.forward_fraction, 1e-15);
    for (double c = -1; c <= 1; c += .01) {
      const double whole = (1 - fine.forward_fraction) * fine.truncated(c);
      EXPECT_NEAR(peak.peak(c) + peak.rest(c), whole, 1e-12 * (1 + std::abs(whole)));
    }
    EXPECT_NEAR(peak.rest(1), (1 - coarse.forward_fraction) * coarse.truncated(1), 1e-12);
    EXPECT_EQ(peak.peak(-.5), 0);
  }
}

TEST(ForwardPeak, CountsAsUnscatteredBelowTheCoarserOrder) {
  // All moments would be the share, were the lobes not cut off beyond the third; these have up to 7 % of it.
  for (const auto& [fine, coarse] : truncations()) {
    const ForwardPeak peak(fine, coarse);
    for (const int l : {0, 1, 2, 4, 8}) {
      EXPECT_NEAR(moment([&](double c) { return peak.peak(c); }, l) / peak.share(), 1, .1) << l;
    }
    // Beyond its order it spreads light: moments of the phase function less the finer f.
    EXPECT_LT(moment([&](double c) { return peak.peak(c); }, 30), .7 * peak.share());
  }
}

TEST(ForwardPeak, IsNoneWhereTheBeamIsNotTruncatedMore) {
  const PhaseFunction backward = PhaseFunction::henyey_greenstein(-.5);
  const PhaseFunction forward = PhaseFunction::henyey_greenstein(.85);
  for (const ForwardPeak& peak : {ForwardPeak(delta_m(backward, 48), delta_m(backward, 12)),
                                  ForwardPeak(delta_m(forward, 12), delta_m(forward, 12))}) {
    EXPECT_EQ(peak.share(), 0);
    for (const double c : {-1., 0., .9, 1.}) EXPECT_EQ(peak.peak(c), 0);
  }
  const ForwardPeak none(delta_m(backward, 48), delta_m(backward, 12));
  EXPECT_NEAR(none.rest(-.3), backward(-.3), 1e-14);
}

TEST(PeakAngles, IntegrateThePeak) {
  // Importance sampling of a signed function: equal shares of its magnitude, with the signs of the lobes.
  for (const auto& [fine, coarse] : truncations()) {
    const std::vector<ForwardPeak> peaks{ForwardPeak(fine, coarse)};
    const std::vector<double> weight{3.};
    const auto angles = peak_angles(peaks, weight, 512);
    ASSERT_EQ(angles.size(), 512U);
    double sum = 0;
    double second = 0;
    for (const auto& [cos_angle, density] : angles) {
      EXPECT_GT(density, 0);
      const double part = peaks[0].peak(cos_angle) / (4 * std::numbers::pi * density * 512);
      sum += part;
      second += part * std::legendre(2, cos_angle);
    }
    const auto peak = [&](double c) { return peaks[0].peak(c); };
    EXPECT_NEAR(sum / peaks[0].share(), moment(peak, 0) / peaks[0].share(), .01);
    EXPECT_NEAR(second / peaks[0].share(), moment(peak, 2) / peaks[0].share(), .01);
    for (std::size_t i = 1; i < angles.size(); ++i) EXPECT_LE(angles[i].cos_angle, angles[i - 1].cos_angle);
  }
}

}  // namespace
}  // namespace cloudbow
