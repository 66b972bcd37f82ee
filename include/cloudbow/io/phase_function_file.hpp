// Phase functions in text files (docs/formats.md): rows of numbers, "#" or "!" begins a comment.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cloudbow/optics/phase_function.hpp"

namespace cloudbow {

struct PhaseFunctionFile {
  PhaseFunction function;
  std::vector<std::string> notes;  ///< guesses and corrections, to be printed for the user
};

/// Rows "l chi_l", l = 0, 1, 2, ..., or "chi_l" alone; chi_0 = 1, without the factor 2l+1. @throws InputError with file
/// and line, and if the function is negative (check_not_negative()).
PhaseFunctionFile read_legendre_file(const std::filesystem::path& file);

/// Rows "angle value", the angles in degrees from 0 to 180, in radians from 0 to pi or as cosines, ascending or
/// descending. The mean over the sphere is 1, or 1/2 or 1/(4 pi), to 1 %: then it is scaled. @throws InputError with
/// file and line.
PhaseFunctionFile read_phase_table_file(const std::filesystem::path& file);

}  // namespace cloudbow
