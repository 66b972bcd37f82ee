// The beam's first scattering as it is seen. Truth: its definition at depth 0, the Poisson series of peaks scattered
// one by one, and what truncation leaves alone.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "cloudbow/optics/beam_phase.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow {
namespace {

constexpr int kOrder = 12;

double at_depth(const BeamPhase& phase, double cosine, double lambda) {
  const std::vector<double> value = phase.at(cosine);
  const double place = BeamPhase::place(lambda);
  const auto node = static_cast<std::size_t>(std::min(place, BeamPhase::nodes - 2.));
  const double share = place - static_cast<double>(node);
  return (1 - share) * value[node] + share * value[node + 1];
}

TEST(BeamPhase, LightThatNeverScatteredSeesThePhaseFunctionItself) {
  for (const PhaseFunction& phase : {PhaseFunction::henyey_greenstein(.85), PhaseFunction::rayleigh()}) {
    const BeamPhase beam(phase, delta_m(phase, kOrder));
    for (const double cosine : {-1., -.3, .6, .99, 1.}) EXPECT_DOUBLE_EQ(at_depth(beam, cosine, 0), phase(cosine));
  }
}

TEST(BeamPhase, WithoutAPeakDepthIsNothing) {
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(-.6);
  const BeamPhase beam(phase, delta_m(phase, kOrder));
  for (const double cosine : {-1., 0., .8}) EXPECT_DOUBLE_EQ(at_depth(beam, cosine, 7), phase(cosine));
}

TEST(BeamPhase, IsThePoissonSumOfPeaksScatteredOneByOne) {
  // k scatterings in the peak G (moments chi_l/f from N on) come before the last, with the probability
  // e^-lambda lambda^k / k!; G^k by its moments, summed term by term as far as factorials matter.
  const double g = .85, lambda = 1.7;
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(g);
  const double f = std::pow(g, kOrder);
  const BeamPhase beam(phase, delta_m(phase, kOrder));
  for (const double cosine : {-.8, .1, .7, .95}) {
    double truth = 0, probability = std::exp(-lambda);
    for (int k = 0; k < 40; ++k) {
      double peak = 0;  // the part of P * G^k that differs from P: moments from N on
      for (int l = kOrder; l < 200; ++l)
        peak += (2 * l + 1) * f * (std::pow(std::pow(g, l) / f, k + 1) - std::pow(g, l) / f) * std::legendre(l, cosine);
      truth += probability * (phase(cosine) + peak);
      probability *= lambda / (k + 1);
    }
    // Nodes are 20 % of lambda apart here; the curvature between them is what is left.
    EXPECT_NEAR(at_depth(beam, cosine, lambda), truth, 1e-2 * std::max(std::abs(truth - phase(cosine)), .02));
  }
}

TEST(BeamPhase, MomentsBelowTheOrderStay) {
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(.9);
  const BeamPhase beam(phase, delta_m(phase, kOrder));
  const GaussLegendre rule = make_gauss_legendre(400);
  for (const double lambda : {.3, 5.}) {
    for (const int l : {0, 1, kOrder - 1}) {
      double moment = 0;
      for (std::size_t i = 0; i < rule.node.size(); ++i)
        moment += .5 * rule.weight[i] * at_depth(beam, rule.node[i], lambda) * std::legendre(l, rule.node[i]);
      EXPECT_NEAR(moment, std::pow(.9, l), 1e-7);  // the quadrature's, for a peak of some 6 degrees
    }
  }
}

}  // namespace
}  // namespace cloudbow
