// Functions of the module cloudbow_vdb, which uses OpenVDB, for vdb_file.cpp. OpenVDB takes longer to load than small
// scenes take to solve. So it is loaded with the first VDB file that is written, or is not ordinary.
#pragma once

#include "cloudbow/medium/vdb_file.hpp"
#include "vdb_read.hpp"

namespace cloudbow {

/// Functions that write are as the public ones of the same names, which document them.
struct VdbModule {
  /// Parses the file in a sandbox, then calls the checks as soon as they can be, and reads the grid.
  VdbGrid (*read_grid)(const std::filesystem::path& path, const std::string& grid, const VdbGridChecks& checks);
  /// The grids with their metadata; none is read as a cloud.
  std::vector<VdbGridInfo> (*list_grids)(const std::filesystem::path& path);
  void (*write_cloud)(const std::filesystem::path& path, const CloudField& field, const VdbWriteOptions& options,
                      const std::vector<VdbAuxiliary>& auxiliaries, const std::vector<VdbCloudGrid>& others);
  void (*write_fields)(const std::filesystem::path& path, const VdbBox& box, std::size_t count,
                       const std::function<VdbField(std::size_t)>& field);
};

}  // namespace cloudbow

/// The module's one symbol.
extern "C" const cloudbow::VdbModule cloudbow_vdb_module;
