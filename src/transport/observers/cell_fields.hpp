// What the converged radiance says of the cells themselves: absorbed power, actinic flux, radiance by direction.
#pragma once

#include "transport/iteration/source_iteration.hpp"
#include "transport/observers/lateral_boundary.hpp"

namespace cloudbow {

/// Fills absorbed_power and actinic_flux where options ask for them.
template <class Real>
void fill_cell_fields(const Problem& problem, const SolverOptions& options, const TransportSystem<Real>& system,
                      const IterationResult<Real>& solved, Solution& solution);

/// Voxel-mean radiance of the delta-scaled problem along the control points of a frame in which none is horizontal.
/// @param surroundings what open sides show; may be null.
/// @param source of the scattered light; its first order is set here.
template <class Real>
RadianceField make_radiance_field(const Problem& problem, const Discretisation& discretisation,
                                  const SolverOptions& options, const TransportSystem<Real>& system,
                                  const IterationResult<Real>& solved, DirectionalSource<Real>& source,
                                  const LateralBoundary* lateral_boundary);

}  // namespace cloudbow
