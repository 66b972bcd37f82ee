// Tables of droplets as files: written as HDF5 that is also netCDF-4, read in that form and in those of others
// (docs/formats.md).
#pragma once

#include <complex>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "cloudbow/optics/droplet_table.hpp"

namespace cloudbow {

struct DropletTableInfo {
  std::complex<double> refractive_index;
  std::string refractive_index_source;
  double density_g_cm3 = 1;
  std::string distribution;
  double effective_variance = 0;
  std::string source;   ///< program name and version
  std::string history;  ///< the command
};

/// Scattering angles [deg] at which phase functions are written: 0 to 180, denser in the forward peak, the rainbow and
/// the glory.
std::vector<double> droplet_table_angles();

/// As write_result(): under a temporary name, renamed when complete. @throws InputError if the file cannot be written.
void write_droplet_table(const std::filesystem::path& file, const DropletTable& table, const DropletTableInfo& info);

/// The same for several wavelengths in one file: tables of the same radii, each with its own refractive index; the rest
/// of their common data are those of the first.
void write_droplet_tables(const std::filesystem::path& file, std::span<const DropletTable> tables,
                          std::span<const DropletTableInfo> infos);

/// Reads a table of any known form, which it recognises by the content:
/// - HDF5 by write_droplet_table() and write_droplet_tables();
/// - netCDF by libRadtran's `mie` (wavelen, reff, ext, ssa, nmom, pmom), classic or netCDF-4;
/// - text by SHDOM's make_mie_table ("! Mie table vs. effective radius").
/// - netCDF of that layout with rows by relative humidity (hum in place of reff), as aerosol tables of OPAC have.
/// @param wavelength_um [um] selects one of a file with several, to 0.1 %.
/// @param relative_humidity_percent needed for rows by humidity, and for no other table. Such a table becomes one row,
/// whose effective radius of 1 um has no meaning.
/// @throws InputError naming the file: no such file, none of these forms, damaged; a variable missing, of the wrong
/// shape or unit; no such wavelength; and as check_droplet_table() says.
DropletTable read_droplet_table(const std::filesystem::path& file, std::optional<double> wavelength_um = std::nullopt,
                                std::optional<double> relative_humidity_percent = std::nullopt);

}  // namespace cloudbow
