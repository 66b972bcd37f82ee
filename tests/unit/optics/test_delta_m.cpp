#include <gtest/gtest.h>

#include <cmath>

#include "cloudbow/optics/delta_m.hpp"

namespace cloudbow {
namespace {

TEST(DeltaM, TruncatesHenyeyGreensteinAsWiscombeDoes) {
  for (const double g : {0.3, 0.85, 0.98}) {
    for (const int order : {1, 8, 16}) {
      const DeltaM scaled = delta_m(PhaseFunction::henyey_greenstein(g), order);
      const double f = std::pow(g, order);
      EXPECT_NEAR(scaled.forward_fraction, f, 1e-16);
      EXPECT_EQ(scaled.truncated.moment(0), 1);
      for (int l = 1; l < order; ++l) {
        EXPECT_NEAR(scaled.truncated.moment(l), (std::pow(g, l) - f) / (1 - f), 1e-15);
        // The peak put back gives the function's own moments.
        EXPECT_NEAR(f + (1 - f) * scaled.truncated.moment(l), std::pow(g, l), 1e-15);
      }
      for (const int l : {order, order + 1, 50}) EXPECT_EQ(scaled.truncated.moment(l), 0);
    }
  }
}

TEST(DeltaM, LeavesWhatIsNoForwardPeakAsItIs) {
  // -.9^12 = .28 would pass for a peak, if the odd moments were not checked.
  for (const auto& phase :
       {PhaseFunction::henyey_greenstein(-0.9), PhaseFunction::henyey_greenstein(-0.5), PhaseFunction::isotropic(),
        PhaseFunction::rayleigh(), PhaseFunction::double_henyey_greenstein(0.6, -0.9, 0.2)}) {
    for (const int order : {3, 8, 12}) {
      const DeltaM scaled = delta_m(phase, order);
      EXPECT_EQ(scaled.forward_fraction, 0);
      EXPECT_EQ(scaled.truncated.key(), phase.key());
    }
  }
}

TEST(DeltaM, TruncatesAForwardPeakOverABackwardLobe) {
  const auto phase = PhaseFunction::double_henyey_greenstein(0.9, -0.3, 0.9);
  EXPECT_NEAR(delta_m(phase, 8).forward_fraction, 0.9 * std::pow(0.9, 8) + 0.1 * std::pow(0.3, 8), 1e-15);
}

}  // namespace
}  // namespace cloudbow
