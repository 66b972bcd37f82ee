// The beam's first scattering as it is seen. Truth: its definition at depth 0, the Poisson series of peaks scattered
// one by one, and what truncation leaves alone.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "cloudbow/optics/beam_phase.hpp"

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

TEST(BeamPhase, StraightOnItAddsUpToSmallAngleTransfer) {
  // What all depths up to lambda send straight on, over (2l+1): exp(-lambda (1 - r)) - exp(-lambda) for each l >= N,
  // and lambda times what is below.
  const double g = .85, lambda = 3;
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(g);
  const double f = std::pow(g, kOrder);
  const BeamPhase beam(phase, delta_m(phase, kOrder));
  double sum = 0;
  constexpr int steps = 3000;
  for (int s = 0; s < steps; ++s) sum += at_depth(beam, 1, lambda * (s + .5) / steps) * lambda / steps;
  double truth = 0;
  for (int l = 0; l < 300; ++l) {
    const double r = std::pow(g, l) / f;
    truth += l < kOrder ? (2 * l + 1) * std::pow(g, l) * lambda
                        : (2 * l + 1) * f * (std::exp(-lambda * (1 - r)) - std::exp(-lambda));
  }
  EXPECT_NEAR(sum / truth, 1, 3e-3);  // linear between nodes
}

}  // namespace
}  // namespace cloudbow
