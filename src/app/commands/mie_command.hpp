// `cloudbow mie`: a table of droplets by Mie theory.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cloudbow {

struct MieOptions {
  std::vector<std::string> wavelength_um{};  ///< each "W" or "FROM:TO:STEP"
  std::string effective_radius_um;           ///< "R" or "FROM:TO:STEP"
  std::string distribution = "gamma";        ///< gamma or lognormal
  double variance = 0.1;                     ///< effective variance
  std::string substance = "water";           ///< water or ice
  std::vector<double> refractive_index{};    ///< n and k, instead of the substance's
  std::optional<double> density_g_cm3{};     ///< default: the substance's; 1 with a refractive index of one's own
  std::filesystem::path output;
  int threads = 0;  ///< 0: all
  bool quiet = false;
  std::string command;  ///< as the user typed it, for the table's history
};

/// Numbers of "X" or "FROM:TO:STEP" (TO included if the steps meet it), all > 0. @throws InputError otherwise, or for
/// more than 1000; its message begins with the option.
std::vector<double> parse_steps(const std::string& option, const std::string& text);

/// @returns exit_done. @throws InputError for anything wrong with the options or the output.
int make_mie_file(const MieOptions& options);

}  // namespace cloudbow
