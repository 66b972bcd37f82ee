// Radiance along parallel lines of sight: what an instrument far above (or below) the scene sees.
#pragma once

#include "cloudbow/transport/seen_source.hpp"
#include "cloudbow/transport/surroundings.hpp"

namespace cloudbow {

/// Images of options.views, in their order. The formal solution along each line of sight (docs/theory.md, "Radiance");
/// light scattered once comes from the phase function itself.
/// @param surroundings what open sides show; may be null.
/// @param solution whose fluxes at the ground, where it has them, light the surface.
/// @param source along the views' directions, a row a view (seen_source.hpp).
template <class Real>
std::vector<RadianceImage> view_radiances(const Problem& problem, const SolverOptions& options,
                                          const TransportSystem<Real>& system, const IterationResult<Real>& solved,
                                          const AngularField<Real>& source, const Surroundings* surroundings,
                                          const Solution& solution);

}  // namespace cloudbow
