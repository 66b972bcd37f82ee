// `cloudbow sweep`: the product of lists of keys, from scenes to one file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/planning/run_options.hpp"
#include "app/process/job_share.hpp"
#include "app/runs/swept_key.hpp"
#include "cloudbow/io/sweep_file.hpp"
#include "cloudbow/medium/cloud_files.hpp"

namespace cloudbow {

struct SweepOptions {
  RunOptions run;              ///< of every run; its output is that of the sweep, its overrides hold in all runs
  std::vector<SweptKey> keys;  ///< with one value: set in all runs
  int jobs = 1;                ///< runs at a time, which share the threads
  std::function<void(std::string&)> show_scene{};  ///< changes the text of a scene for its result; may be empty
  std::optional<JobShare> share{};                 ///< its runs alone are solved and kept, and no file is written
};

/// One run of a sweep, before it is solved.
struct PlannedSweepRun {
  std::vector<std::string> settings;  ///< "KEY=VALUE" of the swept keys
  std::string scene;                  ///< its text, as results show it
  std::uint64_t key = 0;              ///< of RunKeys
  bool done = false;                  ///< its result was kept
  bool to_solve = false;              ///< neither done nor in the share of another job
};

struct SweepPlan {
  std::vector<SweepDimension> dimensions;
  std::vector<PlannedSweepRun> runs;  ///< the last dimension fastest
  std::string scene;                  ///< the text of the scene before keys are swept
  std::size_t to_solve = 0;           ///< runs of which that is true
  std::uint64_t memory_bytes = 0;     ///< peak, predicted, of the runs that are solved at a time
  double seconds = 0;                 ///< of the runs to solve, predicted
  std::string text;                   ///< all of it in lines for a terminal
  std::shared_ptr<CloudFiles> files;  ///< clouds of all runs
  std::set<std::string> printed;      ///< notes on the scenes, which were printed
};

/// Checks every scene of the product. @throws InputError for anything wrong with one of them, if they have different
/// coordinates, or if memory is too little; Interrupted.
SweepPlan plan_sweep(const SweepOptions& options);

struct SweepOutcome {
  int exit_code = 0;                   ///< the gravest of the runs: 1 before 2 before 3 before 0
  std::vector<std::string> sentences;  ///< on runs that failed or did not converge
  bool written = false;                ///< the file is that of this sweep: at least one run has a result
  std::size_t kept = 0;                ///< finished runs of other sweeps that stay in the folder
};

/// Solves the runs that are not done and, without a share, writes the file. @throws InputError, Interrupted: finished
/// runs are kept.
SweepOutcome solve_sweep(const SweepOptions& options, const SweepPlan& plan);

/// Plans, solves, prints. @returns the exit code.
int sweep(const SweepOptions& options);

}  // namespace cloudbow
