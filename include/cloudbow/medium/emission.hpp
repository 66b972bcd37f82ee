// Thermal emission of the matter of a grid, from temperatures.
#pragma once

#include <functional>
#include <vector>

#include "cloudbow/medium/atmosphere.hpp"
#include "cloudbow/medium/cloud_field.hpp"
#include "cloudbow/medium/optical_grid.hpp"

namespace cloudbow {

/// Temperatures of the voxels of a cloud: [n] K, in the order of CloudField::value.
using VoxelTemperatures = std::vector<float>;

/// Fills OpticalGrid::planck, planck_step, layer_planck and layer_planck_step.
/// In a voxel of the cloud all matter has the voxel's temperature, if temperatures are given. It is linear in height in
/// the voxel: its slope is that of the voxels directly above and below. A voxel without such neighbours has the slope
/// of the air. All other matter has the temperature of the air at its height.
/// @param grid of this cloud, as make_optical_grid() returns it.
/// @param air temperature [K] at a height [m]. @param planck radiance at a temperature [K]. Several threads call both.
/// @param cloud, temperatures may be null.
void set_emission(OpticalGrid& grid, const std::function<double(double)>& air,
                  const std::function<double(double)>& planck, const CloudField* cloud = nullptr,
                  const VoxelTemperatures* temperatures = nullptr);

/// Heights between bottom and top, ascending, without these two: levels that end there have a Planck radiance almost
/// linear in height. It departs from its chord by less than `tolerance` of the largest radiance between bottom and top.
/// @param tolerance 1e-6 to 1
std::vector<double> heights_where_planck_is_linear(const Atmosphere& atmosphere,
                                                   const std::function<double(double)>& planck, double bottom_m,
                                                   double top_m, double tolerance);

}  // namespace cloudbow
