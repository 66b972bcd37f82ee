// Cloud files read once, however many wavelengths are solved with what is in them.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "cloudbow/medium/cloud_field.hpp"
#include "cloudbow/medium/vdb_file.hpp"

namespace cloudbow {

/// The grids of one cloud. One that is asked for again comes from memory, where they are kept.
class CloudFiles {
 public:
  /// @param keep grids will be asked for more than once
  explicit CloudFiles(bool keep) : keep_(keep) {}

  /// As read_cloud_vdb().
  CloudField field(const std::filesystem::path& file, const VdbReadOptions& options);
  /// As read_companion_vdb().
  std::vector<float> companion(const std::filesystem::path& file, const CloudField& field,
                               const VdbReadOptions& options, double low, double high);

 private:
  bool keep_;
  std::map<std::string, CloudField> field_;
  std::map<std::string, std::vector<float>> companion_;
};

}  // namespace cloudbow
