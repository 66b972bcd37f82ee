// Thermal emission of the matter of a grid, from temperatures.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "cloudbow/medium/cloud_field.hpp"
#include "cloudbow/medium/optical_grid.hpp"

namespace cloudbow {

/// Temperatures of the voxels of a cloud: [n] K, in the order of CloudField::value.
using VoxelTemperatures = std::vector<float>;

/// Fills OpticalGrid::planck and its companions. In a voxel of the cloud all matter has the voxel's temperature, if
/// these are given. It is linear in height in the voxel, with the slope of the voxels above and below; where there are
/// none, that of the air. All other matter has the temperature of the air at its height.
/// @param air temperature [K] at a height [m]. @param planck radiance at a temperature.
/// @param cloud, temperatures may be null.
void set_emission(OpticalGrid& grid, const std::function<double(double)>& air,
                  const std::function<double(double)>& planck, const CloudField* cloud = nullptr,
                  const VoxelTemperatures* temperatures = nullptr);

}  // namespace cloudbow
