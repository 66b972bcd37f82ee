#include "cloudbow/results/energy_fluxes.hpp"

namespace cloudbow {

EnergyFluxes energy_fluxes(const EnergyLedger& ledger) {
  const double power = ledger.power;
  return {power * ledger.incident,
          power * ledger.surface_emission,
          power * ledger.reflectance,
          power * ledger.transmittance,
          power * ledger.transmittance_direct,
          power * ledger.absorptance,
          power * ledger.surface_absorptance,
          power * ledger.side_gain,
          power * ledger.side_loss,
          power * ledger.residual};
}

}  // namespace cloudbow
