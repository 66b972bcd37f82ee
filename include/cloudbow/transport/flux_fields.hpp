// From the converged radiance to fluxes through planes: by the last gather where columns exchange light, by the
// ordinates themselves where they do not (docs/theory.md, "Last gather").
#pragma once

#include "cloudbow/transport/gather.hpp"
#include "cloudbow/transport/surroundings.hpp"

namespace cloudbow {

/// Fills the fluxes, their profiles, transmittance_direct and the gather's rescaling.
/// @param surroundings what open sides show; may be null.
template <class Real>
void fill_flux_fields(const Problem& problem, const Discretisation& discretisation, const SolverOptions& options,
                      const TransportSystem<Real>& system, const IterationResult<Real>& solved,
                      const Surroundings* surroundings, const ProgressCallback& progress, Solution& solution);

}  // namespace cloudbow
