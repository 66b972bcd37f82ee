#pragma once

#include "cloudbow/medium/vdb_file.hpp"

namespace cloudbow::vdb {

/// write_cloud_vdb, within the module.
void write_cloud(const std::filesystem::path& path, const CloudField& field, const VdbWriteOptions& options,
                 const std::vector<VdbCompanion>& companions);

}  // namespace cloudbow::vdb
