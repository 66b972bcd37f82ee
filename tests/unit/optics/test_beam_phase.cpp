// The beam's first scattering as it is seen. Truth: its definition at depth 0, the Poisson series of peaks scattered
// one by one, and the range that truncation leaves unchanged.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "cloudbow/optics/beam_phase.hpp"

namespace cloudbow {
namespace {

constexpr int beam_order = 12;

double at_depth(const BeamPhase& phase, double cosine, double lambda) {
  const std::vector<double> value = phase.at(cosine);
  const double place = BeamPhase::place(lambda);
  const auto node = static_cast<std::size_t>(std::min(place, BeamPhase::nodes - 2.));
  const double share = place - static_cast<double>(node);
  return (1 - share) * value[node] + share * value[node + 1];
}

TEST(BeamPhase, LightThatNeverScatteredSeesThePhaseFunctionItself) {
  for (const PhaseFunction& phase : {PhaseFunction::henyey_greenstein(.85), PhaseFunction::rayleigh()}) {
    const BeamPhase beam(phase, delta_m(phase, beam_order));
    for (const double cosine : {-1., -.3, .6, .99, 1.}) EXPECT_DOUBLE_EQ(at_depth(beam, cosine, 0), phase(cosine));
  }
}

TEST(BeamPhase, WithoutAPeakDepthIsNothing) {
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(-.6);
  const BeamPhase beam(phase, delta_m(phase, beam_order));
  for (const double cosine : {-1., 0., .8}) EXPECT_DOUBLE_EQ(at_depth(beam, cosine, 7), phase(cosine));
}

TEST(BeamPhase, AsideDepthIsNothing) {
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(.85);
  const BeamPhase beam(phase, delta_m(phase, beam_order));
  const double resolved = std::numbers::pi / beam_order;
  for (const double angle : {1.001 * resolved, 2., 3.})
    EXPECT_DOUBLE_EQ(at_depth(beam, std::cos(angle), 7), phase(std::cos(angle)));
  EXPECT_LT(at_depth(beam, std::cos(.4 * resolved), 7), phase(std::cos(.4 * resolved)));
}

TEST(BeamPhase, StraightOnItAddsUpToSmallAngleTransfer) {
  // Light that all depths up to lambda scatter straight forward, over (2l+1): exp(-lambda (1 - r)) - exp(-lambda) for
  // each l >= N. Below N: lambda times the moment.
  const double g = .85, lambda = 3;
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(g);
  const double f = std::pow(g, beam_order);
  const BeamPhase beam(phase, delta_m(phase, beam_order));
  double sum = 0;
  constexpr int steps = 3000;
  for (int s = 0; s < steps; ++s) sum += at_depth(beam, 1, lambda * (s + .5) / steps) * lambda / steps;
  double truth = 0;
  for (int l = 0; l < 300; ++l) {
    const double r = std::pow(g, l) / f;
    truth += l < beam_order ? (2 * l + 1) * std::pow(g, l) * lambda
                            : (2 * l + 1) * f * (std::exp(-lambda * (1 - r)) - std::exp(-lambda));
  }
  EXPECT_NEAR(sum / truth, 1, 3e-3);  // linear between nodes
}

}  // namespace
}  // namespace cloudbow
