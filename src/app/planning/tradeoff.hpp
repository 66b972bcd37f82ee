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
  std::filesystem::path reference;     ///< result file taken as the truth for errors; empty: the best level solved
  std::filesystem::path csv, plot;     ///< empty: none
  int threads = 0;                     ///< 0: all
  bool quiet = false;                  ///< no progress
  std::uint64_t memory_bytes = 0;      ///< levels that need more are left out; 0: the memory available
};

/// "independent-columns" and "independent-diffuse" (at draft), then the levels of accuracy from the coarsest on.
std::vector<std::string> tradeoff_levels();

/// Solves each level by `cloudbow run` in a separate process, which isolates its time and memory; prints the table.
/// Without `levels`, modes of columns that lack an output of the scene are omitted and named below the table.
/// @returns exit_done, or exit_not_converged if a level did not converge. @throws InputError for errors in the scene or
/// the options, or if no level fits into memory; Interrupted.
int tradeoff(const TradeoffOptions& options);

}  // namespace cloudbow
