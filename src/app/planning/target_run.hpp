// Runs to a wanted error or time: a draft first, then the level that serves.
#pragma once

#include <cstdint>
#include <vector>

#include "app/planning/solve_scenes.hpp"
#include "cloudbow/io/result_file.hpp"

namespace cloudbow {

struct TargetRun {
  std::vector<Scene> scenes;  ///< at the level chosen
  Solved solved;
  TargetReport report;
};

/// Prints the chosen level and the reason on stderr. @throws InputError if no level suffices, with the possible values;
/// Interrupted.
TargetRun reach_target(const RunOptions& options, std::uint64_t available, CloudFiles& files);

}  // namespace cloudbow
