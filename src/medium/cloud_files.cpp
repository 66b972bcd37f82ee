#include "cloudbow/medium/cloud_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cstdint>

#include "cloudbow/core/digest.hpp"

namespace cloudbow {
namespace {

/// All that the reading of a grid depends on.
std::string key_of(const std::filesystem::path& file, const VdbReadOptions& options, double low, double high) {
  const VdbDomain domain = options.domain_m.value_or(VdbDomain{});
  return fmt::format("{}\n{}\n{} {} {} {} {} {} {} {} {}", file.string(), options.grid, options.scale, low, high,
                     options.auxiliary_quantity, options.up_axis,
                     fmt::join(options.voxel_size_m.value_or(std::array<double, 3>{}), " "),
                     fmt::join(domain.min_m, " "), fmt::join(domain.max_m, " "), options.ignores_background);
}

/// Stands for the voxels of a field: constituents of one file have different ones.
std::uint64_t voxels_of(const CloudField& field) {
  Digest digest;
  digest.add_bytes(field.row_begin.data(), field.row_begin.size() * sizeof(field.row_begin.front()));
  digest.add_bytes(field.spans.data(), field.spans.size() * sizeof(RowSpan));
  return digest.value();
}

}  // namespace

void CloudFiles::note(const std::string& sentence) {
  const std::lock_guard lock(mutex_);
  if (report_ && reported_.insert(sentence).second) report_(sentence);
}

VdbCloud CloudFiles::field(const std::filesystem::path& file, const VdbReadOptions& options) {
  const std::lock_guard lock(mutex_);
  const std::string key = key_of(file, options, 0, 0);
  if (const auto kept = field_.find(key); kept != field_.end()) return kept->second;
  VdbCloud field = read_cloud_vdb(file, options);
  for (const std::string& sentence : field.notes) note("note: " + sentence);
  if (keep_) field_.emplace(key, field);
  return field;
}

std::vector<float> CloudFiles::auxiliary(const std::filesystem::path& file, const CloudField& field,
                                         const VdbReadOptions& options, double low, double high) {
  const std::lock_guard lock(mutex_);
  const std::string key = fmt::format("{}\n{}", key_of(file, options, low, high), voxels_of(field));
  if (const auto kept = auxiliary_.find(key); kept != auxiliary_.end()) return kept->second;
  std::vector<float> value = read_auxiliary_vdb(file, field, options, low, high);
  if (keep_) auxiliary_.emplace(key, value);
  return value;
}

}  // namespace cloudbow
