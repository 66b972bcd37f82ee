// Fields of the cells from the converged radiance: absorbed power, actinic flux, radiance by direction.
#pragma once

#include <span>

#include "transport/iteration/source_iteration.hpp"
#include "transport/observers/converged_field.hpp"
#include "transport/observers/lateral_boundary.hpp"

namespace cloudbow {

/// Whether absorption by layers in blocks is requested: it needs the light voxel by voxel.
template <class Real>
bool needs_light_within_blocks(const TransportSystem<Real>& system, const SolverOptions& options);

/// Fills absorbed_power and actinic_flux if options request them.
/// @param source of the scattered light, for absorption by layers in blocks; its first order is replaced. Null: there
/// are no blocks. @param scalar_flux [n] of the diffuse light
template <class Real>
void fill_cell_fields(const ConvergedField<Real>& field, DirectionalSource<Real>* source,
                      std::span<const Real> scalar_flux, Solution& solution);

/// Voxel-mean radiance of the delta-scaled problem along the control points of a frame in which none is horizontal.
/// @param source of the scattered light; its first order is set here.
template <class Real>
RadianceField make_radiance_field(const ConvergedField<Real>& field, DirectionalSource<Real>& source);

}  // namespace cloudbow
