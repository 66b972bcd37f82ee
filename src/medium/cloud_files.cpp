#include "cloudbow/medium/cloud_files.hpp"

#include <fmt/format.h>

namespace cloudbow {
namespace {

/// The options of reading that a scene can change from wavelength to wavelength; the rest is the same for one cloud.
std::string key_of(const VdbReadOptions& options, double low, double high) {
  return fmt::format("{} {} {} {} {}", options.grid, options.scale, low, high, options.auxiliary_quantity);
}

}  // namespace

void CloudFiles::note(const std::string& sentence) {
  if (tell_ && told_.insert(sentence).second) tell_(sentence);
}

VdbCloud CloudFiles::field(const std::filesystem::path& file, const VdbReadOptions& options) {
  const std::string key = key_of(options, 0, 0);
  if (const auto kept = field_.find(key); kept != field_.end()) return kept->second;
  VdbCloud field = read_cloud_vdb(file, options);
  for (const std::string& sentence : field.notes) note("note: " + sentence);
  if (keep_) field_.emplace(key, field);
  return field;
}

std::vector<float> CloudFiles::auxiliary(const std::filesystem::path& file, const CloudField& field,
                                         const VdbReadOptions& options, double low, double high) {
  const std::string key = key_of(options, low, high);
  if (const auto kept = auxiliary_.find(key); kept != auxiliary_.end()) return kept->second;
  std::vector<float> value = read_auxiliary_vdb(file, field, options, low, high);
  if (keep_) auxiliary_.emplace(key, value);
  return value;
}

}  // namespace cloudbow
