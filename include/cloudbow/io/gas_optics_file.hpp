// Optical depths of the air by g-point as a file: HDF5 that is also netCDF-4 (docs/formats.md, "Optics of the air").
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cloudbow/medium/gas_model.hpp"

namespace cloudbow {

struct GasOpticsData {
  GasModel::Light light = GasModel::Light::longwave;
  std::vector<double> height_m;       ///< [layers + 1] of the interfaces, ascending
  std::vector<double> pressure_pa;    ///< [layers + 1]
  std::vector<double> temperature_k;  ///< [layers + 1]
  GasModel::LayerOptics optics;
  std::vector<std::vector<double>> planck;  ///< [points][layers + 1] W m-2 sr-1; longwave
  std::vector<double> solar_share;          ///< [points]; solar
  std::string source;                       ///< program name and version
  std::string history;                      ///< the command
};

/// As write_result(): under a temporary name, renamed when complete. @throws InputError if the file cannot be written.
void write_gas_optics(const std::filesystem::path& file, const GasOpticsData& data);

}  // namespace cloudbow
