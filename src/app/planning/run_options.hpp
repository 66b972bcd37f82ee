// Options of `cloudbow run` apart from the scene.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/planning/planner.hpp"
#include "app/process/job_share.hpp"

namespace cloudbow {

class Ranks;
class SolveShare;

struct RunOptions {
  std::filesystem::path scene;
  std::vector<std::string> overrides;  ///< "KEY=VALUE"
  std::filesystem::path
      output;       ///< empty: as the scene gives it, else the scene's name with .h5 in the working directory
  int threads = 0;  ///< 0: all
  bool quiet = false;
  bool compare = false;          ///< solve as independent columns too and write the differences of the column fluxes
  bool clear_sky = false;        ///< solve the scene without its clouds too
  bool dry_run = false;          ///< validate, predict memory and time, write nothing
  std::optional<Target> target;  ///< the level of accuracy is chosen, in place of the scene's
  std::filesystem::path checkpoint;  ///< keeps the state of the iteration here; empty: nowhere
  double checkpoint_minutes = 10;    ///< interval, >= 0; also written when a signal ends the run, and at its end
  std::filesystem::path resume;      ///< begins with the state here; empty: from nothing
  std::string command;               ///< as the user typed it, for the result's history
  std::optional<JobShare> part;      ///< solves of this job, which go to a part of the result; none: all, to the result
  Ranks* ranks = nullptr;            ///< processes that run the same command; null: this one alone
  std::shared_ptr<SolveShare> share{};  ///< the solves of this process; null: all
};

}  // namespace cloudbow
