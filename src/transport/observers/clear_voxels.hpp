// Light in the single voxels beside clouds whose layers are in blocks.
#pragma once

#include <vector>

#include "transport/observers/converged_field.hpp"
#include "transport/scattering/directional_source.hpp"

namespace cloudbow {

/// Actinic flux of each voxel, (k*ny + j)*nx + i, relative to the mean over its block; 1 in voxels with a cell of their
/// own. It is that of one march along each ordinate through the voxels, with the converged source. Above the highest
/// level with a voxel of the clouds light hardly varies: these levels are left out.
/// @param source of the field; its first order of scattering is replaced.
template <class Real>
std::vector<float> light_within_blocks(const ConvergedField<Real>& field, DirectionalSource<Real>& source);

}  // namespace cloudbow
