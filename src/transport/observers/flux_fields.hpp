// From the converged radiance to fluxes through planes. The final gather computes them if columns exchange light,
// otherwise the ordinates do (docs/theory.md, "Final gather").
#pragma once

#include "transport/gather/gather.hpp"
#include "transport/iteration/source_iteration.hpp"
#include "transport/observers/converged_field.hpp"
#include "transport/observers/lateral_boundary.hpp"

namespace cloudbow {

/// Each rank that shares the field gets the source of all cells at the control points that it gathers from. Does
/// nothing if there is one rank.
/// @param source of the cells of this rank. @param whole the first rank gets all points
template <class Real>
void share_source(const ConvergedField<Real>& field, bool whole, DirectionalSource<Real>& source);

/// Fills the fluxes, their profiles, transmittance_direct and the gather's rescaling.
/// @param source of the scattered light; its first order is set here. Null for independent columns: the fluxes of the
/// iteration are taken. All ranks that share the field call this; the first has the fluxes.
template <class Real>
void fill_flux_fields(const ConvergedField<Real>& field, DirectionalSource<Real>* source,
                      const ProgressCallback& progress, Solution& solution);

}  // namespace cloudbow
