// Optics of droplets or ice by wavenumber and effective radius, as tables of bulk properties give them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace cloudbow {

/// Mass extinction, single-scattering albedo and asymmetry parameter.
struct BulkOptics {
  double extinction_m2_per_g = 0;
  double single_scattering_albedo = 0;
  double asymmetry = 0;
};

/// A table by wavenumber and effective radius, linear between its nodes in radius.
struct BulkTable {
  std::vector<double> wavenumber_cm1;          ///< ascending
  std::vector<double> effective_radius_um;     ///< ascending
  std::vector<std::vector<BulkOptics>> value;  ///< [wavenumber][radius]
};

/// Reads a table in the layout of ecRad's scattering files (netCDF). @throws InputError.
BulkTable read_bulk_table(const std::filesystem::path& file);

/// The table averaged over a spectral weight: k = <k>, ssa = <k ssa>/<k>, g = <k ssa g>/<k ssa>. The asymmetry is
/// rounded to .002, so that g-points share phase functions.
/// @param wavenumber_cm1, weight the weight by wavenumber, linear between; any unit, not all 0.
/// @returns [radius]
std::vector<BulkOptics> average_over(const BulkTable& table, std::span<const double> wavenumber_cm1,
                                     std::span<const double> weight);

/// At a radius, linear between nodes. @throws InputError beyond the table's radii, with the range.
BulkOptics at_radius(const BulkTable& table, std::span<const BulkOptics> averaged, double effective_radius_um);

}  // namespace cloudbow
