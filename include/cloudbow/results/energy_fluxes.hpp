// The energy ledger in W m-2.
#pragma once

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Means over the domain's horizontal area, in W m-2 or, at one wavelength of emission, W m-2 um-1. The terms
/// incident, surface_emitted and side_gain come in; the others, without residual, go out.
struct EnergyFluxes {
  double incident = 0;         ///< of sun and sky through the top
  double surface_emitted = 0;  ///< by the ground
  double upwelling_top = 0;
  double downwelling_bottom = 0;  ///< direct and diffuse
  double direct_bottom = 0;
  double absorbed = 0;  ///< by matter, less what it emits
  double surface_absorbed = 0;
  double side_gain = 0;
  double side_loss = 0;
  double residual = 0;

  /// Absorbed by the ground, less what it emits.
  double surface_net() const { return surface_absorbed - surface_emitted; }
};

EnergyFluxes energy_fluxes(const EnergyLedger& ledger);

}  // namespace cloudbow
