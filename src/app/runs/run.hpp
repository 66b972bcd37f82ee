// `cloudbow run`: one scene from file to file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "app/planning/run_options.hpp"
#include "app/planning/solve_scenes.hpp"
#include "cloudbow/app/scene.hpp"
#include "cloudbow/io/result_file.hpp"
#include "cloudbow/medium/cloud_files.hpp"

namespace cloudbow {

/// The scenes of a run, one per wavelength or g-point, before any cloud is opened.
struct PreparedRun {
  std::vector<Scene> scenes;
  std::filesystem::path output;  ///< the result
};

/// Answer of a dry run.
struct RunEstimate {
  std::array<int, 3> cells{};  ///< columns along x and y, levels
  std::size_t active_cells = 0;
  std::uint64_t memory_bytes = 0;     ///< peak, predicted
  std::uint64_t available_bytes = 0;  ///< memory of this machine
  double seconds = 0;                 ///< predicted
  std::string text;                   ///< all of it in lines for a terminal, with figures of the cloud
  /// Coordinates of the result by name, and sizes of images.
  std::map<std::string, std::vector<double>> coordinates;
};

/// A run before its result is written.
struct SolvedRun {
  std::vector<Scene> scenes;  ///< as solved; one for all g-points of a gas model
  Solved solved;
  ResultInfo info;
};

/// Bytes that a run may take: processes that share a machine share its memory.
std::uint64_t available_memory(const RunOptions& options);

/// Reads the scenes and checks options and files against them; prints what reading guessed or corrected.
/// @throws InputError.
PreparedRun prepare_run(const RunOptions& options);
/// The same of one of several runs. @param printed notes so far: each is printed once
PreparedRun prepare_run(const RunOptions& options, std::set<std::string>& printed);

/// Opens the cloud and predicts the cost. @throws InputError, also if memory is too little; Interrupted.
RunEstimate estimate_run(const std::vector<Scene>& scenes, const RunOptions& options);
/// @param files clouds of this run and of others
RunEstimate estimate_run(const std::vector<Scene>& scenes, const RunOptions& options, CloudFiles& files);

/// @throws InputError, Interrupted.
SolvedRun solve_run(const std::vector<Scene>& scenes, const RunOptions& options);
SolvedRun solve_run(const std::vector<Scene>& scenes, const RunOptions& options, CloudFiles& files);

/// Writes the result file. @throws InputError, Interrupted.
void write_run(const std::filesystem::path& output, const SolvedRun& run, int threads);

/// A sentence for each solution that did not converge, and for a target that was missed; none if all is well.
/// @param output name of the result, for the sentences
std::vector<std::string> shortcomings(const SolvedRun& run, const std::string& output);

/// Writes and prints the result. @returns the exit code as run() does. @throws InputError, Interrupted.
int finish_run(const PreparedRun& prepared, const SolvedRun& solved, const RunOptions& options);

/// @returns exit_done, or exit_not_converged: the solve did not reach its tolerance, the energy ledger does not close
/// or the result misses the target. The result is written in all cases.
/// @throws InputError, Interrupted.
int run(const RunOptions& options);

}  // namespace cloudbow
