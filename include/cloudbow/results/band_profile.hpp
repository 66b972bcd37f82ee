// Domain means of light by bands of a gas model.
#pragma once

#include <array>
#include <vector>

#include "cloudbow/medium/gas_model.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Means over the domain of all g-points of a band.
struct BandProfile {
  std::array<double, 2> wavenumber_cm1{};
  std::vector<double> upwelling_flux;            ///< [nz + 1] W m-2
  std::vector<double> downwelling_diffuse_flux;  ///< [nz + 1]
  std::vector<double> direct_flux;               ///< [nz + 1]
  std::vector<double> absorbed_power;            ///< [nz] W m-3, less emission; empty: not in the solutions
};

/// One for each band of the model, without light.
std::vector<BandProfile> band_profiles(const GasModel& model);

/// Adds the solution at a g-point to the profile of its band.
void add_to_band(const Solution& solution, BandProfile& band);

}  // namespace cloudbow
