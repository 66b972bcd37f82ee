// `cloudbow tradeoff`: one scene at every level of the accuracy ladder, errors beside time and memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace cloudbow {

struct TradeoffOptions {
  std::filesystem::path scene;
  std::vector<std::string> overrides;  ///< "KEY=VALUE"
  std::vector<std::string> levels;     ///< of tradeoff_levels(), in any order; empty: all
  std::filesystem::path reference;     ///< result file that errors are against; empty: the best level solved
  std::filesystem::path csv, plot;     ///< empty: none
  int threads = 0;                     ///< 0: all
  bool quiet = false;                  ///< no progress
  std::uint64_t memory_bytes = 0;      ///< levels that need more are left out; 0: what the machine has
};

/// "independent-columns" and "independent-diffuse" (at draft), then the levels of accuracy from the coarsest on.
std::vector<std::string> tradeoff_levels();

/// Solves each level by `cloudbow run` in a process of its own, so that its time and memory are its own; prints the
/// table.
/// Without `levels`, a mode of columns that cannot do what the scene asks for is left out and named below the table.
/// @returns exit_done, or exit_not_converged where a level did not converge.
/// @throws InputError for anything wrong with the scene or the options, where no level fits into memory; Interrupted.
int tradeoff(const TradeoffOptions& options);

}  // namespace cloudbow
