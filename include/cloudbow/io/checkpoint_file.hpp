// States of iterations in files (HDF5, every value under a checksum).
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "cloudbow/transport/checkpoints.hpp"

namespace cloudbow {

/// As write_result(): nothing half-written under the name. @param source program name and version.
/// @throws InputError if it cannot be written.
void write_checkpoint(const std::filesystem::path& file, const std::string& source, const StateKey& key,
                      std::span<const StateArray> state);

class CheckpointInput {
 public:
  /// @throws InputError if there is no such file, or write_checkpoint() of this version did not make it.
  explicit CheckpointInput(const std::filesystem::path& file);
  ~CheckpointInput();
  CheckpointInput(const CheckpointInput&) = delete;
  CheckpointInput& operator=(const CheckpointInput&) = delete;

  const StateKey& key() const { return key_; }
  const std::string& source() const { return source_; }

  /// @throws InputError if the array is missing, has another shape or is damaged.
  void load(const StateArray& array) const;

 private:
  struct Opened;
  std::filesystem::path path_;
  std::unique_ptr<Opened> opened_;
  StateKey key_;
  std::string source_;
};

}  // namespace cloudbow
