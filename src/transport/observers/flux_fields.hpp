// From the converged radiance to fluxes through planes: by the final gather where columns exchange light, by the
// ordinates themselves where they do not (docs/theory.md, "Final gather").
#pragma once

#include "transport/iteration/source_iteration.hpp"
#include "transport/observers/gather.hpp"
#include "transport/observers/lateral_boundary.hpp"

namespace cloudbow {

/// Fills the fluxes, their profiles, transmittance_direct and the gather's rescaling.
/// @param surroundings what open sides show; may be null.
/// @param source of the scattered light; its first order is set here. Null where columns exchange no light: the
/// iteration's own fluxes are taken.
template <class Real>
void fill_flux_fields(const Problem& problem, const Discretisation& discretisation, const SolverOptions& options,
                      const TransportSystem<Real>& system, const IterationResult<Real>& solved,
                      DirectionalSource<Real>* source, const LateralBoundary* lateral_boundary,
                      const ProgressCallback& progress, Solution& solution);

}  // namespace cloudbow
