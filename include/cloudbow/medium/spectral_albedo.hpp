// Albedo of the surface by wavelength, and its means for g-points.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cloudbow/medium/gas_model.hpp"

namespace cloudbow {

/// Albedo at wavelengths, linear between them; beyond the ends the nearest value.
struct SpectralAlbedo {
  std::vector<double> wavelength_um;  ///< ascending, at least one, .1 to 1000
  std::vector<double> albedo;         ///< 0 to 1
};

/// Part of the spectrum's power that may lie beyond the wavelengths of a spectral albedo.
inline constexpr double largest_power_beyond_albedo = .1;

/// @param name begins each message. @throws InputError if it is not as SpectralAlbedo says.
void check_spectral_albedo(const SpectralAlbedo& albedo, const std::string& name);

/// Text of two columns, wavelength and albedo: docs/formats.md, "Albedo by wavelength". Either order of wavelengths.
/// @throws InputError that names the file and the line, what was found and what is allowed.
SpectralAlbedo read_spectral_albedo(const std::filesystem::path& file);

/// Mean albedo over the weight of each g-point, weight_of_point().
/// @param name begins messages: the file or the key. @returns [points]
/// @throws InputError if more than largest_power_beyond_albedo of the power lies beyond the wavelengths of the albedo.
std::vector<double> albedo_of_points(const GasModel& model, const SpectralAlbedo& albedo, const std::string& name);

}  // namespace cloudbow
