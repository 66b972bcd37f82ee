// Functions of the module cloudbow_vdb, which uses OpenVDB, for vdb_file.cpp. OpenVDB takes longer to load than small
// scenes take to solve. So it is loaded with the first VDB file.
#pragma once

#include "cloudbow/medium/vdb_file.hpp"

namespace cloudbow {

/// Functions as the public ones of the same names, which document them.
struct VdbModule {
  VdbCloud (*read_cloud)(const std::filesystem::path& path, const VdbReadOptions& options);
  std::vector<float> (*read_auxiliary)(const std::filesystem::path& path, const CloudField& cloud,
                                       const VdbReadOptions& options, double lowest, double highest);
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
