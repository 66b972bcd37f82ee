// Truth: another fit to the same physics, by others with other refractive indices of air (Bodhaine et al. 1999, J.
// Atmos. Oceanic Technol. 16, 1854, Eq. 30, good from 0.25 to 0.85 um).
#include <gtest/gtest.h>

#include <cmath>

#include "../near_with_report.hpp"
#include "cloudbow/optics/rayleigh.hpp"

namespace cloudbow {
namespace {

double bodhaine_optical_depth(double wavelength_um) {
  const double square = wavelength_um * wavelength_um;
  return 0.0021520 * (1.0455996 - 341.29061 / square - 0.90230850 * square) /
         (1 + 0.0027059889 / square - 85.968563 * square);
}

TEST(Rayleigh, AgreesWithBodhaine) {
  // The two agree to 0.3 % in visible light; they differ in the depolarisation of air there.
  for (const double um : {0.35, 0.4, 0.45, 0.55, 0.67, 0.85}) {
    EXPECT_NEAR(rayleigh_optical_depth(um) / bodhaine_optical_depth(um), 1, 5e-3) << um;
  }
}

TEST(Rayleigh, FallsWithTheFourthPowerInTheInfrared) {
  EXPECT_NEAR(rayleigh_optical_depth(4) / rayleigh_optical_depth(8), 16, 16 * 1e-3);  // dispersion: 0.0113 / 16 um2
}

}  // namespace
}  // namespace cloudbow
