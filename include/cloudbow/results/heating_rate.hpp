// Heating of the air by absorbed power.
#pragma once

#include <vector>

#include "cloudbow/medium/atmosphere.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Specific heat of dry air at constant pressure, J kg-1 K-1.
inline constexpr double specific_heat = 1004;

/// Absorbed power over the heat capacity of the air: P / (rho c_p). K s-1, or K s-1 um-1 if fluxes are at a wavelength.
struct HeatingRate {
  std::vector<float> cell;      ///< [nz][ny][nx]
  std::vector<double> profile;  ///< [nz] means over the domain
};

/// @param solution with absorbed power.
HeatingRate heating_rate(const Solution& solution, const Atmosphere& air);

/// Density of the air, mean over a level of a box, kg m-3.
double mean_density(const Atmosphere& air, double bottom_m, double top_m);

}  // namespace cloudbow
