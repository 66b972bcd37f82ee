// Progress of a solve on stderr: a bar on a terminal, a line per sweep elsewhere. In a HostScope it is the host's.
#pragma once

#include <string>

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

class ProgressDisplay {
 public:
  /// @param tolerance the estimated error at which the bar is full.
  ProgressDisplay(bool quiet, double tolerance);
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
  double first_error_ = 0;
  double shown_fraction_ = 0;
  bool bar_open_ = false;
  std::string last_phase_;
};

}  // namespace cloudbow
