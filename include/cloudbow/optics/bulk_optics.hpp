// Optics of droplets or ice by wavenumber and effective radius, as tables of bulk properties give them.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace cloudbow {

/// Mass extinction, single-scattering albedo and asymmetry parameter.
struct BulkOptics {
  double extinction_m2_per_g = 0;
  double single_scattering_albedo = 0;  ///< 0 to 1; 0 if there is no extinction
  double asymmetry = 0;                 ///< -1 to 1; 0 if nothing is scattered
};

/// A table by wavenumber and effective radius. Between wavenumbers k, k ssa and k ssa g are linear, with k the mass
/// extinction; between radii two rows mix, as in DropletTable.
struct BulkTable {
  std::vector<double> wavenumber_cm1;          ///< ascending
  std::vector<double> effective_radius_um;     ///< ascending
  std::vector<std::vector<BulkOptics>> value;  ///< [wavenumber][radius]
  std::string name{};                          ///< begins the messages about it: its file, as a rule
};

/// Asymmetry parameters are rounded to this, so that g-points share phase functions.
inline constexpr double asymmetry_step = .002;
/// Part of a weight that may lie beyond the wavenumbers of a table, on both sides together. The table goes on there
/// with its end values. Tables of ice begin at 101 cm-1; below lies up to 9 % of a longwave g-point.
inline constexpr double largest_extended_share = .1;

/// @throws InputError "NAME: ...": no wavenumber or radius, or some that do not ascend; radii outside the range of
/// DropletTable; arrays of other lengths; extinction <= 0; albedo outside 0 to 1; asymmetry outside -1 to 1.
void check_bulk_table(const BulkTable& table);

/// The table averaged over a spectral weight: k = <k>, ssa = <k ssa>/<k>, g = <k ssa g>/<k ssa>, the asymmetry rounded
/// to asymmetry_step. The integrals are exact (node_shares()). Without extinction ssa is 0, without scattering g is 0.
/// @param wavenumber_cm1, weight as in SpectralWeight.
/// @returns [radius] @throws InputError if more than largest_extended_share of the weight lies beyond the table, with
/// both ranges.
std::vector<BulkOptics> average_over(const BulkTable& table, std::span<const double> wavenumber_cm1,
                                     std::span<const double> weight);

/// At a radius: the mixture of two neighbouring rows that has it. Masses add up, and 1/r_e is linear in the share of
/// mass. So are k, k ssa and k ssa g. The asymmetry is rounded again.
/// @throws InputError beyond the table's radii, with the range.
BulkOptics at_radius(const BulkTable& table, std::span<const BulkOptics> averaged, double effective_radius_um);

}  // namespace cloudbow
