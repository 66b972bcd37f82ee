// Amounts in a cloud: extinction of its water, and sums over its columns.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cloudbow/medium/cloud_field.hpp"

namespace cloudbow {

/// Extinction coefficient of droplets, 3 LWC / (2 rho_w r_e) with an extinction efficiency of 2: in 1/m for LWC in
/// g/m3, r_e in um and rho_w = 1e6 g/m3.
constexpr double extinction_per_liquid_water(double effective_radius_um) { return 1.5 / effective_radius_um; }

/// Quantities of grids that hold g/m3: "liquid_water_content", "rain_water_content", "ice_water_content",
/// "snow_water_content", "graupel_water_content".
std::vector<std::string> water_contents();

/// Density [g/cm3] by which such a content becomes extinction: 1 of liquid and rain, .917 of the others, whose
/// effective radius is that of solid ice, 3 volume / (4 projected area). None of other quantities.
std::optional<double> density_of_water(const std::string& quantity);

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
