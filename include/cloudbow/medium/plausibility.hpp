// Numbers that no cloud has: what a unit taken for another leaves behind.
#pragma once

#include <optional>
#include <string>

namespace cloudbow {

/// Effective radii of droplets and ice crystals, by which water becomes extinction [um].
inline constexpr double smallest_effective_radius_um = 0.1;
inline constexpr double largest_effective_radius_um = 5000;

/// Temperatures of droplets and ice crystals [K].
inline constexpr double coldest_cloud_k = 150;
inline constexpr double warmest_cloud_k = 350;

/// A sentence about a liquid water content above 20 g/m3; none below.
std::optional<std::string> doubt_water_content(double largest_g_m3);

/// A sentence about a voxel of an optical depth above 1e4, from its bottom to its top; none below.
std::optional<std::string> doubt_optical_depth(double largest_of_a_voxel);

/// A sentence about radii outside the range above; none inside.
std::optional<std::string> doubt_effective_radius(double smallest_um, double largest_um);

/// The `cloud.scale` that converts the units of a file: an extinction to 1/m, a water content to g/m3. None if
/// these units are not recognised.
std::optional<double> scale_of_units(const std::string& quantity, const std::string& units);

}  // namespace cloudbow
