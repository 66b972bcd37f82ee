#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "transport/columns/polar_streams.hpp"

namespace cloudbow {
namespace {

// Gauss-Legendre of a half range: polynomials up to degree 2n - 1 are exact.
TEST(PolarStreams, IntegratePolynomialsOfTheCosine) {
  for (const int count : {2, 8, 32}) {
    const PolarStreams streams = make_polar_streams(count, {}, std::nullopt);
    ASSERT_EQ(streams.size(), count);
    for (int degree = 0; degree < 2 * count; ++degree) {
      double sum = 0;
      for (int i = 0; i < count; ++i) {
        const auto n = static_cast<std::size_t>(i);
        sum += streams.weight[n] * std::pow(streams.cosine[n], degree);
      }
      EXPECT_NEAR(sum, 1. / (degree + 1), 1e-13) << count << " " << degree;
    }
    for (int i = 1; i < count; ++i)
      EXPECT_LT(streams.cosine[static_cast<std::size_t>(i - 1)], streams.cosine[static_cast<std::size_t>(i)]);
  }
}

// Isotropic scattering: upward and downward light scatter alike, from any direction, and no peak is truncated.
TEST(PolarStreams, IsotropicScatteringHasNoOddPart) {
  const std::vector<PhaseFunction> phase{PhaseFunction::isotropic()};
  const PolarStreams streams = make_polar_streams(4, phase, .5);
  const PolarStreams::Scattering& scattering = streams.phase.front();
  EXPECT_EQ(scattering.diffuse_fraction, 0);
  EXPECT_EQ(scattering.beam_fraction, 0);
  ASSERT_EQ(scattering.even.size(), 10U);
  for (const double odd : scattering.odd) EXPECT_NEAR(odd, 0, 1e-14);
  for (const double odd : scattering.from_beam_odd) EXPECT_NEAR(odd, 0, 1e-14);
  for (std::size_t i = 0, at = 0; i < 4; ++i) {  // symmetric by the roots of the weights
    for (std::size_t j = 0; j <= i; ++j, ++at)
      EXPECT_NEAR(scattering.even[at], std::sqrt(streams.weight[i] * streams.weight[j]), 1e-14);
  }
}

// The fraction of Henyey-Greenstein at order M is g^M (Wiscombe 1977): 2n for diffuse light.
TEST(PolarStreams, PeaksAreTruncatedAtTheOrderOfTheStreams) {
  const std::vector<PhaseFunction> phase{PhaseFunction::henyey_greenstein(.85)};
  const PolarStreams streams = make_polar_streams(8, phase, .7);
  EXPECT_NEAR(streams.phase.front().diffuse_fraction, std::pow(.85, 16), 1e-12);
  EXPECT_LE(streams.phase.front().beam_fraction, streams.phase.front().diffuse_fraction);
}

}  // namespace
}  // namespace cloudbow
