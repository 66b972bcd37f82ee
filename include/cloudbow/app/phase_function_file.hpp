// Phase functions in text files: lines of two numbers, "#" begins a comment.
#pragma once

#include <filesystem>

#include "cloudbow/optics/phase_function.hpp"

namespace cloudbow {

/// Lines "l chi_l", l = 0, 1, 2, ..., chi_0 = 1, without the factor 2l+1. @throws InputError with file and line.
PhaseFunction read_legendre_file(const std::filesystem::path& file);

/// Lines "angle_deg value", angles ascending from 0 to 180. @throws InputError with file and line.
PhaseFunction read_phase_table_file(const std::filesystem::path& file);

}  // namespace cloudbow
