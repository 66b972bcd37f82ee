#pragma once

#include "cloudbow/medium/vdb_file.hpp"

namespace cloudbow::vdb {

/// write_cloud_vdb, within the module.
void write_cloud(const std::filesystem::path& path, const CloudField& field, const VdbWriteOptions& options,
                 const std::vector<VdbAuxiliary>& auxiliaries, const std::vector<VdbCloudGrid>& others);

/// write_fields_vdb, within the module.
void write_fields(const std::filesystem::path& path, const VdbBox& box, std::size_t count,
                  const std::function<VdbField(std::size_t)>& field);

}  // namespace cloudbow::vdb
