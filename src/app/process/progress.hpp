// Progress of a solve on stderr: a bar on a terminal, a line per sweep elsewhere. In a HostScope it is the host's.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Time that a run of several solves has left, as if all took equally long.
class RunClock {
 public:
  explicit RunClock(std::size_t solves) : solves_(solves) {}

  void finish_solve() { ++finished_; }
  /// Seconds left; none as long as too little is done. @param fraction of the present solve, 0 to 1
  std::optional<double> seconds_left(double fraction) const;
  /// The same from numbers. @param fraction of the run
  static std::optional<double> seconds_left(double elapsed_seconds, double fraction);

 private:
  std::size_t solves_, finished_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// "40 s left", "12 min left", "3 h 20 min left".
std::string time_left_text(double seconds);

/// Fraction of a solve that is done. Its phases have fixed shares of the time. @param phase as SolverProgress has it;
/// another one is the whole. @param fraction of the phase
double solve_fraction(const std::string& phase, double fraction);

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
