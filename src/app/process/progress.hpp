// Progress of a solve on stderr: a bar on a terminal, a line per sweep elsewhere. In a HostScope it is the host's.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cloudbow/transport/solution.hpp"
#include "cloudbow/transport/solve_seconds.hpp"

namespace cloudbow {

/// Time that a run has left: its predicted time, at the pace of the sweeps and phases that are done.
class RunClock {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// @param solves predicted seconds of each solve of the run, with the coarse solves that follow it.
  explicit RunClock(std::vector<double> solves) : solves_(std::move(solves)) {}

  /// @param phases predicted seconds of the solve that begins. Without them, progress is a fraction of the whole solve.
  void begin_solve(const SolveSeconds& phases) { phases_ = phases; }
  /// The solve and its coarse solves count as done.
  void finish_solve();
  /// Seconds left; none as long as too little is done. Called with all progress of the present solve.
  /// @param fraction of the phase, 0 to 1; of the sweeps, that of the way to the tolerance
  std::optional<double> seconds_left(const SolverProgress& progress, double fraction,
                                     Time now = std::chrono::steady_clock::now());

 private:
  std::vector<double> solves_;
  std::optional<SolveSeconds> phases_;
  std::size_t finished_ = 0;
  double done_ = 0;            // predicted seconds of the finished solves
  std::optional<Time> start_;  // of what they and the present solve measure: tables of phase functions do not count
};

/// "40 s left", "12 min left", "3 h 20 min left".
std::string time_left_text(double seconds);

class ProgressDisplay {
 public:
  /// @param tolerance the estimated error at which the bar is full.
  /// @param clock of the run, in which this is one solve; it must live longer. Null: no time left is shown.
  ProgressDisplay(bool quiet, double tolerance, RunClock* clock = nullptr);
  ~ProgressDisplay();
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  void show(const SolverProgress& progress);

 private:
  void show_bar(const SolverProgress& progress);
  void show_line(const SolverProgress& progress);

  bool quiet_;
  bool terminal_;
  double tolerance_;
  RunClock* clock_;
  double first_error_ = 0;
  double shown_fraction_ = 0;
  bool bar_open_ = false;
  std::string last_phase_;
};

}  // namespace cloudbow
