// The air by height: pressure, temperature and gases.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace cloudbow {

/// Profiles at heights, linear between them in height (pressure: its logarithm).
struct Atmosphere {
  std::vector<double> height_m;                              ///< ascending, at least two
  std::vector<double> pressure_pa;                           ///< descending, > 0
  std::vector<double> temperature_k;                         ///< 100 to 400
  std::map<std::string, std::vector<double>> mole_fraction;  ///< by gas ("h2o", "o3", "co2", "ch4", "n2o"), 0 to 1

  // Beyond its ends the nearest value; pressure goes on with the scale height of the end.
  double temperature_at(double height_m) const;  ///< K
  double pressure_at(double height_m) const;     ///< Pa
  double density_at(double height_m) const;      ///< kg m-3, of dry air at that pressure and temperature
};

/// The US standard atmosphere 1976 from -1 to 84.8 km above the sea, a closed form: temperature and pressure only.
/// Between its heights, interpolation is exact to .01 K and to 1e-4 of the pressure.
Atmosphere us_standard_1976();

/// Text columns as AFGL profiles have them, or netCDF with CF variables: docs/formats.md, "Profiles of the air".
/// @throws InputError that names the file, the line or variable, what was found and what is allowed.
Atmosphere read_atmosphere(const std::filesystem::path& file);

/// Order, length and range of all profiles. @param name begins each message. @throws InputError
void check_atmosphere(const Atmosphere& atmosphere, const std::string& name);

}  // namespace cloudbow
