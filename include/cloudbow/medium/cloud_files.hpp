// Cloud files read once, however many wavelengths are solved with what is in them.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cloudbow/medium/cloud_field.hpp"
#include "cloudbow/medium/vdb_file.hpp"

namespace cloudbow {

/// The grids of clouds. If grids are kept, a repeated request returns the one in memory. Several threads may use one
/// object.
class CloudFiles {
 public:
  /// @param keep grids will be requested more than once.
  /// @param report is called with each sentence about the cloud, once; may be empty.
  explicit CloudFiles(bool keep, std::function<void(const std::string&)> report = {})
      : keep_(keep), report_(std::move(report)) {}

  /// Reports a sentence once.
  void note(const std::string& sentence);

  /// As read_cloud_vdb(); its notes are reported.
  VdbCloud field(const std::filesystem::path& file, const VdbReadOptions& options);
  /// As read_auxiliary_vdb().
  std::vector<float> auxiliary(const std::filesystem::path& file, const CloudField& field,
                               const VdbReadOptions& options, double low, double high);

 private:
  std::recursive_mutex mutex_;
  bool keep_;
  std::function<void(const std::string&)> report_;
  std::set<std::string> reported_;
  std::map<std::string, VdbCloud> field_;
  std::map<std::string, std::vector<float>> auxiliary_;
};

}  // namespace cloudbow
