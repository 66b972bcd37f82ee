// The file of `cloudbow phase`.
#pragma once

#include <filesystem>
#include <string>

#include "cloudbow/results/phase_report.hpp"

namespace cloudbow {

/// HDF5 that is also netCDF-4: see docs/formats.md, "The phase function file".
/// @param source name and version of the program.
/// @param history time and command.
/// @throws InputError if the file can't be written.
void write_phase_file(const std::filesystem::path& file, const PhaseReport& report, const std::string& source,
                      const std::string& history);

}  // namespace cloudbow
