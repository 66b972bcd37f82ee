// The rules by which a float grid becomes a cloud, for any reader of files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "cloudbow/medium/vdb_file.hpp"
#include "vdb_grid.hpp"

namespace cloudbow {

/// Called by readers; they throw if the grid is not allowed, before its voxels take memory.
struct VdbGridChecks {
  std::function<void(const VdbGridHeader& header)> header{};
  std::function<void(double active_voxels)> voxels{};
};

/// Reads a float grid. @throws InputError if the file or the grid cannot be read, or as the checks do.
/// @param memory_bytes that reading may take
using VdbGridReader = std::function<VdbGrid(const std::filesystem::path& path, const std::string& grid,
                                            std::uint64_t memory_bytes, const VdbGridChecks& checks)>;

/// As read_cloud_vdb().
VdbCloud read_cloud(const VdbGridReader& reader, const std::filesystem::path& path, const VdbReadOptions& options);

/// As read_auxiliary_vdb().
std::vector<float> read_auxiliary(const VdbGridReader& reader, const std::filesystem::path& path,
                                  const CloudField& cloud, const VdbReadOptions& options, double lowest,
                                  double highest);

/// Reads with OpenVDB, in a sandbox first. Loads the module.
VdbGrid read_grid_by_openvdb(const std::filesystem::path& path, const std::string& grid, std::uint64_t memory_bytes,
                             const VdbGridChecks& checks);

/// Reads ordinary files without OpenVDB, and all others with it.
VdbGrid read_grid(const std::filesystem::path& path, const std::string& grid, std::uint64_t memory_bytes,
                  const VdbGridChecks& checks);

}  // namespace cloudbow
