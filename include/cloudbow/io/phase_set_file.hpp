// Sets of phase functions by their Legendre moments, as text: one column a function (docs/formats.md).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cloudbow {

/// Whether the numbers of a file are chi_l or (2l+1) chi_l. Automatic: the latter if any is above 1, or
/// if a function were negative otherwise.
enum class MomentFactor { excluded, included, automatic };

struct PhaseSetFile {
  std::vector<std::vector<double>> moments;  ///< [function][l] without the factor, chi_0 = 1; trailing zeros cut
  bool factor_was_included = false;
  std::string note;  ///< note for the user on the first function that rings below 0, if any does
};

/// @throws InputError with file and line: not numbers, degrees not 0, 1, 2, ..., rows of different length, chi_0 not 1,
/// |chi_l| above 1, a function that is negative.
PhaseSetFile read_phase_set_file(const std::filesystem::path& file, MomentFactor factor);

/// Without the factor. @throws InputError if it cannot be written.
void write_phase_set_file(const std::filesystem::path& file, const std::vector<std::vector<double>>& moments);

}  // namespace cloudbow
