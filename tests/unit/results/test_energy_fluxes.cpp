// The ledger as fluxes. Truth: fractions times the power.
#include <gtest/gtest.h>

#include "cloudbow/results/energy_fluxes.hpp"

namespace cloudbow {
namespace {

TEST(EnergyFluxes, AreFractionsOfThePower) {
  EnergyLedger ledger;
  ledger.power = 8;
  ledger.incident = 1;
  ledger.surface_emission = .5;
  ledger.reflectance = .25;
  ledger.transmittance = .125;
  ledger.transmittance_direct = .0625;
  ledger.absorptance = .75;
  ledger.surface_absorptance = .375;
  ledger.side_gain = 2;
  ledger.side_loss = 3;
  ledger.residual = 4;
  const EnergyFluxes fluxes = energy_fluxes(ledger);
  EXPECT_EQ(fluxes.incident, 8);
  EXPECT_EQ(fluxes.surface_emitted, 4);
  EXPECT_EQ(fluxes.upwelling_top, 2);
  EXPECT_EQ(fluxes.downwelling_bottom, 1);
  EXPECT_EQ(fluxes.direct_bottom, .5);
  EXPECT_EQ(fluxes.absorbed, 6);
  EXPECT_EQ(fluxes.surface_absorbed, 3);
  EXPECT_EQ(fluxes.side_gain, 16);
  EXPECT_EQ(fluxes.side_loss, 24);
  EXPECT_EQ(fluxes.residual, 32);
  EXPECT_EQ(fluxes.surface_net(), -1);
}

TEST(EnergyFluxes, OfADarkSceneAreZero) { EXPECT_EQ(energy_fluxes({}).upwelling_top, 0); }

}  // namespace
}  // namespace cloudbow
