// Scattering into rings about the sun. Truth: closed forms of the rings and of Henyey and Greenstein's function. Also
// the derivative of the carried light, and its sum over the whole sphere.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "cloudbow/optics/circumsolar_phase.hpp"

namespace cloudbow {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr int truncation_order = 12;

CircumsolarPhase of_one(const PhaseFunction& phase, std::span<const ConeRing> rings) {
  const std::vector<PhaseFunction> phases{phase};
  const std::vector<DeltaM> truncation{delta_m(phase, truncation_order)};
  const std::vector<double> weight{1};
  return {phases, truncation, weight, rings};
}

double at_depth(std::span<const double> nodes, double lambda) {
  const double place = CircumsolarPhase::place(lambda);
  const auto node = static_cast<std::size_t>(std::min(place, CircumsolarPhase::nodes - 2.));
  const double share = place - static_cast<double>(node);
  return (1 - share) * nodes[node] + share * nodes[node + 1];
}

// Integral of P cos over the cosine, from that of `angle` to 1, with q^2 = 1 + g^2 - 2 g cos.
double henyey_greenstein_in_cone(double g, double angle) {
  const auto antiderivative = [g](double q) { return -(1 + g * g) / q - q; };
  const double widest = std::sqrt(1 + g * g - 2 * g * std::cos(angle));
  return (1 - g * g) / (2 * g * g) * (antiderivative(widest) - antiderivative(1 - g));
}

TEST(ConeRing, RingsShareTheCone) {
  // A cone of half angle a sends pi sin^2 a through a plane across its axis.
  for (const double half : {.05 * degree, 3 * degree, 10 * degree}) {
    double power = 0, moment = 0;
    for (const ConeRing& ring : cone_rings(half, 3)) {
      power += ring.power();
      moment += ring.power() * ring.mean_cosine();
    }
    const double cosine = std::cos(half);
    EXPECT_NEAR(power / (std::numbers::pi * std::pow(std::sin(half), 2)), 1, 1e-12);
    EXPECT_NEAR(moment / power, 2. / 3 * (1 + cosine + cosine * cosine) / (1 + cosine), 1e-12);
  }
}

TEST(CircumsolarPhase, LightThatScattersOnceSeesThePhaseFunctionItself) {
  for (const double g : {.85, .99, -.6}) {
    const PhaseFunction phase = PhaseFunction::henyey_greenstein(g);
    const std::vector<ConeRing> rings = cone_rings(3 * degree, 3);
    const CircumsolarPhase of_rings = of_one(phase, rings);
    for (std::size_t n = 0; n < rings.size(); ++n) {
      const double expected =
          (henyey_greenstein_in_cone(g, rings[n].outer) - henyey_greenstein_in_cone(g, rings[n].inner)) * 2 *
          std::numbers::pi / rings[n].power();
      const double peak = of_rings.peak(0, n).empty() ? 0 : of_rings.peak(0, n)[0];
      // 64 Gauss angles per ring; the closed form is a difference of numbers up to 1e5 times as large.
      EXPECT_NEAR((of_rings.rest(0, n) + peak) / expected, 1, 1e-9) << g;
    }
  }
}

TEST(CircumsolarPhase, WithoutAPeakNothingIsCarried) {
  const std::vector<ConeRing> rings = cone_rings(5 * degree, 2);
  const CircumsolarPhase phase = of_one(PhaseFunction::rayleigh(), rings);
  EXPECT_FALSE(phase.has_peak());
  EXPECT_TRUE(phase.peak(0, 1).empty());
  EXPECT_NEAR(phase.rest(0, 0), 1.5, 3e-3);  // 3/4 (1 + cos^2) within 2.5 degrees
  for (const double carried : phase.carried(1)) EXPECT_EQ(carried, 0);
}

TEST(CircumsolarPhase, EmissionIsTheIncreaseOfTheCarriedLight) {
  // d carried / d lambda = peak / f. Nodes are 7.5 % of lambda + .05 apart: central differences of the carried light
  // err by the square of that over 6, at most .2 % of its largest change.
  const double g = .9;
  const std::vector<ConeRing> rings = cone_rings(4 * degree, 2);
  const CircumsolarPhase phase = of_one(PhaseFunction::henyey_greenstein(g), rings);
  const double f = std::pow(g, truncation_order);
  for (std::size_t ring = 0; ring < 2; ++ring) {
    const std::span<const double> carried = phase.carried(ring), peak = phase.peak(0, ring);
    const auto depth = [](int node) {
      double low = 0, high = 100;
      for (int n = 0; n < 60; ++n) (CircumsolarPhase::place((low + high) / 2) < node ? low : high) = (low + high) / 2;
      return low;
    };
    for (int node = 1; node < CircumsolarPhase::nodes - 1; node += 5) {
      const double slope = (carried[node + 1] - carried[node - 1]) / (depth(node + 1) - depth(node - 1));
      EXPECT_NEAR(slope, peak[node] / f, 4e-3 * std::abs(peak[0] / f)) << node;
    }
  }
}

TEST(CircumsolarPhase, TheWholeSphereHoldsAllCarriedLight) {
  // Over all directions the carried light is 1 - exp(-lambda). Most of that of a narrow peak lies within 40 degrees,
  // and its cosine is less than 1: the bounds are the moments r_1 = 1 and r_2 = 1.
  const std::vector<ConeRing> rings = cone_rings(89 * degree, 60);
  const CircumsolarPhase phase = of_one(PhaseFunction::henyey_greenstein(.95), rings);
  for (const double lambda : {.1, 1., 5.}) {
    double along = 0;  // integral of the carried radiance times the cosine
    for (std::size_t n = 0; n < rings.size(); ++n)
      along += at_depth(phase.carried(n), lambda) * rings[n].power() / (4 * std::numbers::pi);
    // r_1 = 1: the integral of the cosine is 1 - exp(-lambda) over the sphere; light behind the horizon rings about 0.
    EXPECT_NEAR(along / (1 - std::exp(-lambda)), 1, 2e-2);
  }
}

TEST(CircumsolarPhase, AMixtureOfEqualFunctionsIsOneOfThem) {
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(.8);
  const std::vector<ConeRing> rings = cone_rings(2 * degree, 1);
  const std::vector<PhaseFunction> phases{phase, PhaseFunction::rayleigh(), phase};
  std::vector<DeltaM> truncation;
  for (const PhaseFunction& p : phases) truncation.push_back(delta_m(p, truncation_order));
  const std::vector<double> weight{.3, 7, 2};
  const CircumsolarPhase mixed(phases, truncation, weight, rings);
  const CircumsolarPhase alone = of_one(phase, rings);
  for (int node = 0; node < CircumsolarPhase::nodes; node += 7) {
    EXPECT_NEAR(mixed.peak(2, 0)[node], alone.peak(0, 0)[node], 1e-9);
    EXPECT_NEAR(mixed.carried(0)[node], alone.carried(0)[node], 1e-9);
  }
}

}  // namespace
}  // namespace cloudbow
