// Optical properties of clouds of droplets at one wavelength, by effective radius.
#pragma once

#include <string>
#include <vector>

#include "cloudbow/optics/phase_function.hpp"

namespace cloudbow {

/// Effective radii in tables [um]: below are molecules, above no drops; both are metres or nanometres taken for um.
inline constexpr double smallest_tabulated_radius_um = 1e-3;
inline constexpr double largest_tabulated_radius_um = 5000;

/// One row for each effective radius. Whoever made it, the table obeys check_droplet_table().
struct DropletTable {
  double wavelength_um = 0;                      ///< 0: not known
  std::vector<double> effective_radius_um;       ///< ascending
  std::vector<double> extinction_m2_per_g;       ///< extinction coefficient [1/m] of 1 g/m3 of water
  std::vector<double> single_scattering_albedo;  ///< 0 to 1
  std::vector<std::vector<double>> moments;      ///< [radius][l] chi_l, chi_0 = 1, without the factor 2l+1
  std::vector<std::string> notes{};              ///< guesses of its reader, to be printed for the user

  std::size_t size() const { return effective_radius_um.size(); }
};

/// @throws InputError if the radius is out of the range above.
void check_tabulated_radius(double radius_um);

/// Checks the values of one row with the limits of check_droplet_table().
/// @returns the note of check_droplet_table() on this row; empty: none. @throws InputError as that function.
/// @param name of the row in messages and in the note: "effective radius 5 um"
std::string check_droplet_row(const DropletTable& table, std::size_t row, const std::string& name);

/// @throws InputError "PROBLEM (found X, allowed Y)": no row, rows of different number, radii that do not ascend,
/// values out of range; chi_0 not 1 or |chi_l| > 1 (to 1e-4, the digits of text tables); a last moment that is not
/// negligible, (2l+1) |chi_l| above 5 % of the largest; phase functions that are negative (check_not_negative()).
/// @returns the note for the user on the first row whose phase function rings below 0.
std::string check_droplet_table(const DropletTable& table);

struct DropletOptics {
  double extinction_m2_per_g;
  double single_scattering_albedo;
  PhaseFunction phase_function;
};

/// Share of water in row `lower + 1`, the rest being in row `lower`.
struct DropletMixture {
  std::size_t lower;
  double upper_share;
};

/// The mixture of the two neighbouring rows that has this effective radius: masses add up, so that 1/r_e is linear in
/// the share of water. @throws InputError if the radius is outside the table.
DropletMixture mixture_for(const DropletTable& table, double effective_radius_um);

/// Extinction and scattering of a mixture, per mass of its water; both add up over the rows.
struct MixedDroplets {
  double extinction_m2_per_g;
  double scattering_m2_per_g;
  double upper_scattering_m2_per_g;  ///< part of the scattering that row `lower + 1` does

  double single_scattering_albedo() const { return scattering_m2_per_g / extinction_m2_per_g; }
  /// Share of the scattering in row `lower + 1`, by which phase functions mix; `if_black` without any scattering.
  double upper_share_of_scattering(double if_black) const {
    return scattering_m2_per_g > 0 ? upper_scattering_m2_per_g / scattering_m2_per_g : if_black;
  }
};
MixedDroplets mix(const DropletTable& table, const DropletMixture& mixture);

/// Optics of that mixture: extinction and scattering add up, and phase functions by the light that each scatters.
DropletOptics droplet_optics(const DropletTable& table, double effective_radius_um);

}  // namespace cloudbow
