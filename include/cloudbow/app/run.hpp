// `cloudbow run`: one scene from file to file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cloudbow/app/planner.hpp"
#include "cloudbow/app/scene.hpp"

namespace cloudbow {

struct RunOptions {
  std::filesystem::path scene;
  std::vector<std::string> overrides;  ///< "KEY=VALUE"
  std::filesystem::path
      output;       ///< empty: what the scene says, else the scene's name with .h5 in the working directory
  int threads = 0;  ///< 0: all
  bool quiet = false;
  bool compare = false;      ///< solve as independent columns too and write the differences of the column fluxes
  bool dry_run = false;      ///< validate, predict memory and time, write nothing
  std::optional<Goal> goal;  ///< the level of accuracy is chosen, in place of the scene's
  std::filesystem::path checkpoint;  ///< keeps the state of the iteration here; empty: nowhere
  double checkpoint_minutes = 10;    ///< after so many, >= 0; and where a signal ends the run, and when it is done
  std::filesystem::path resume;      ///< begins with the state here; empty: from nothing
  std::string command;               ///< as the user typed it, for the result's history
};

/// Exit codes of the program.
inline constexpr int kExitDone = 0;
inline constexpr int kExitInternalError = 1;
inline constexpr int kExitInputError = 2;
inline constexpr int kExitNotConverged = 3;
inline constexpr int kExitDoesNotHold = 3;  ///< a check of `cloudbow verify` failed

/// @returns kExitDone, or kExitNotConverged where the solve did not reach its tolerance or the ledger does not close,
/// or where the result misses the goal: it is written all the same.
/// @throws InputError, Interrupted.
int run(const RunOptions& options);

/// Peak memory [bytes] of run() for the wavelengths of a scene.
/// @param available bytes that the optical grid may take. @throws InputError as assemble().
std::size_t foreseen_memory(const std::vector<Scene>& scenes, std::uint64_t available, int threads);


}  // namespace cloudbow
