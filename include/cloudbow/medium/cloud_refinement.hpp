// Clouds on finer voxels.
#pragma once

#include <span>
#include <vector>

#include "cloudbow/medium/cloud_field.hpp"

namespace cloudbow {

inline constexpr int least_refinement = 2, largest_refinement = 8;

/// Divides each voxel into factor^3 parts. Between the centres of voxels values are trilinear. Then the parts of each
/// voxel are multiplied by one number that makes their mean the value of the voxel. Clear voxels stay clear, and equal
/// neighbours stay equal. Beyond the box values are those at its rim.
/// @param factor from least_refinement to largest_refinement.
/// @param periodic the field repeats beyond the sides of the box.
/// @throws InputError if the parts do not fit into memory.
CloudField refine_cloud(const CloudField& field, int factor, bool periodic);

/// Another quantity of the voxels, the same in all parts of each. @param of_voxels in the order of field.value
/// @param refined refine_cloud(field, factor)
std::vector<float> values_of_parts(const CloudField& field, const CloudField& refined, int factor,
                                   std::span<const float> of_voxels);

}  // namespace cloudbow
