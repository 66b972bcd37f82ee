// The result file: HDF5 that is also netCDF-4 (docs/formats.md).
#pragma once

#include <filesystem>
#include <string>

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

struct ResultInfo {
  std::string title;
  std::string source;   ///< program name and version
  std::string history;
  std::string scene;    ///< the whole scene file as run
};

/// Writes beside the target under a temporary name, flushes, closes, fsyncs, renames: no half file under the name.
/// @throws InputError naming the file where it can't be written (no folder, no rights, disk full).
void write_result(const std::filesystem::path& file, const Solution& solution, const ResultInfo& info);

}  // namespace cloudbow
