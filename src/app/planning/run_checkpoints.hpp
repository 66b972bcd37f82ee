// The checkpoints of a run: written every few minutes, when a signal ends the run, and at the iteration's end.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include "app/planning/run_options.hpp"
#include "cloudbow/io/checkpoint_file.hpp"

namespace cloudbow {

class RunCheckpoints : public Checkpoints {
 public:
  /// @param of number of the solve within the run, `solves` in all: of several each has files of its own.
  /// @throws InputError if there is nothing to resume from.
  RunCheckpoints(const RunOptions& options, std::size_t of, std::size_t solves);

  Found find(const StateKey& key) override;
  void load(const StateArray& array) override;
  [[noreturn]] void refuse(const std::string& problem) override;
  void loaded(int sweeps) override;
  bool due() override;
  /// A file that cannot be written is reported and does not end the run. @throws Interrupted after it is written, if a
  /// signal has arrived.
  void save(const StateKey& key, std::span<const StateArray> state) override;
  /// Whether the solve had a state to resume from or to keep: columns that are solved without iteration have none.
  bool used() const { return used_; }

 private:
  bool used_ = false;
  bool quiet_;
  std::filesystem::path to_;    // empty: nothing is kept
  std::filesystem::path from_;  // empty: nothing to resume from
  std::chrono::duration<double> every_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::unique_ptr<CheckpointInput> input_;
  std::string source_;
};

/// The file of one of several solves: FILE, or FILE.1, FILE.2, ...; empty if FILE is.
std::filesystem::path checkpoint_file(const std::filesystem::path& file, std::size_t of, std::size_t solves);

}  // namespace cloudbow
