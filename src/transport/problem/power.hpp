// Power of the light sources of a problem, per horizontal area: the unit of the energy ledger (docs/theory.md,
// "Energy").
#pragma once

#include "cloudbow/transport/problem.hpp"

namespace cloudbow {

/// Power of sun and sky through the horizontal top, W m-2.
double incident_power(const Problem& problem);

/// Mean over the columns of the flux that the ground emits, (1 - albedo) pi B, W m-2. A ground with a BRDF counts as
/// black, which is an upper bound: its emissivity depends on the ordinates.
double ground_emission(const Problem& problem);

/// Mean over the columns of what their matter would emit if nothing scattered, W m-2: the fluxes up at the top and down
/// at the ground. Transmission is exp(-5/3 tau) at the vertical optical depth tau of absorption.
double matter_emission(const Problem& problem);

}  // namespace cloudbow
