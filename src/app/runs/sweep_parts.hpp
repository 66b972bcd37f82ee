// Results of the finished runs of a sweep, kept until the sweep is complete.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "app/planning/run_options.hpp"
#include "cloudbow/app/scene.hpp"

namespace cloudbow {

/// Identifies runs by all that their results depend on.
class RunKeys {
 public:
  /// Digest of the scene, the contents of its inputs, the options and the version.
  /// @param text the scene as results show it
  /// @throws InputError if an input cannot be read.
  std::uint64_t of(const Scene& scene, const std::string& text, const RunOptions& options);

 private:
  std::uint64_t contents_of(const std::filesystem::path& file);

  std::map<std::filesystem::path, std::uint64_t> contents_;
};

/// ResultInfo::run_key of a run.
std::string run_key_text(std::uint64_t key);

/// The folder FILE.parts beside the output. The name of each result contains the key of its run, so that results of
/// other scenes are not used.
class SweepParts {
 public:
  explicit SweepParts(const std::filesystem::path& output);

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path file(std::uint64_t key) const;
  /// Whether the result of a run is there and can be read to its end. A result without the key of the run is another.
  bool has(std::uint64_t key) const;
  /// Reports before a long computation whether the folder cannot be made or written to. Makes nothing.
  /// @throws InputError.
  void check() const;
  /// Makes the folder. @throws InputError if that fails.
  void make() const;
  /// Removes the results of these runs and their temporary files. The folder goes too if nothing else is in it.
  /// @returns the number of results of other runs, which stay.
  std::size_t remove(std::span<const std::uint64_t> keys) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace cloudbow
