// `cloudbow run --part` and `cloudbow merge`: a run in parts, and its result from them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/runs/run.hpp"

namespace cloudbow {

struct MergeOptions {
  std::vector<std::filesystem::path> parts;
  std::filesystem::path output;  ///< empty: as the runs of the parts name it
  int threads = 0;               ///< 0: all
  bool quiet = false;
  std::string command;  ///< as the user typed it, for the result's history
};

/// Solves the share of RunOptions::part and writes it to a part. @returns the exit code. @throws InputError,
/// Interrupted.
int solve_part(const PreparedRun& prepared, RunOptions options);

/// Joins all parts of a run into its result, with the bits of one run. @returns the exit code.
/// @throws InputError, also if a part is missing or if the scene or its inputs have changed; Interrupted.
int merge(const MergeOptions& options);

}  // namespace cloudbow
