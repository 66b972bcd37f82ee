// Density of the air by height, from a file beside the cloud's.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "cloudbow/medium/atmosphere.hpp"

namespace cloudbow {

struct AirProfile {
  std::filesystem::path file;
  std::vector<double> height_m;            ///< ascending, at least two
  std::vector<double> density_kg_m3;       ///< 0.01 to 2
  std::optional<Atmosphere> atmosphere{};  ///< pressure and temperature, if the file has these

  /// Between heights the logarithm of the density is linear. Beyond the ends it goes on so for one step of the heights.
  /// @throws InputError at other heights
  double density_at(double height_m) const;
};

/// Text with a comment "# z(m) rho(kg/m3)", netCDF with a density, or what read_atmosphere() reads.
/// @throws InputError that names file, line or variable, what was found and what is allowed
AirProfile read_air_profile(const std::filesystem::path& file);

}  // namespace cloudbow
