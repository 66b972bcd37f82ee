// Amounts in a cloud: extinction of its water, and sums over its columns.
#pragma once

#include <span>

#include "cloudbow/medium/cloud_field.hpp"

namespace cloudbow {

/// Extinction coefficient of droplets, 3 LWC / (2 rho_w r_e) with an extinction efficiency of 2: in 1/m for LWC in
/// g/m3, r_e in um and rho_w = 1e6 g/m3.
constexpr double extinction_per_liquid_water(double effective_radius_um) { return 1.5 / effective_radius_um; }

/// Of ice; 1 for water.
inline constexpr double ice_density_g_cm3 = 0.917;

/// The same of ice crystals, whose effective radius is that of their volume and projected area.
constexpr double extinction_per_ice(double effective_radius_um) {
  return extinction_per_liquid_water(effective_radius_um) / ice_density_g_cm3;
}

/// Replaces liquid water contents [g/m3] by extinction coefficients [1/m].
/// @param extinction_m2_per_g [voxel] extinction coefficient of 1 g/m3
void water_to_extinction(CloudField& field, std::span<const double> extinction_m2_per_g);

/// The same by extinction_per_liquid_water().
/// @param effective_radius_um [voxel]
void water_to_extinction_by_radius(CloudField& field, std::span<const float> effective_radius_um);

/// Vertical integrals over the columns of a cloud, in the units of its values times metres.
struct ColumnFigures {
  double sum = 0;      ///< over all columns
  double largest = 0;  ///< of a single column
};

/// @param factor multiplies the values
ColumnFigures column_figures(const CloudField& field, double factor);

double largest_value(const CloudField& field);

}  // namespace cloudbow
