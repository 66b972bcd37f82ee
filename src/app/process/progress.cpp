#include "app/process/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "app/process/host.hpp"
#include "app/process/messages.hpp"

namespace cloudbow {

ProgressDisplay::ProgressDisplay(bool quiet, double tolerance)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1), tolerance_(tolerance) {}

ProgressDisplay::~ProgressDisplay() {
  if (bar_open_) std::fputc('\n', stderr);
}

void ProgressDisplay::show(const SolverProgress& progress) {
  if (const HostCalls* host = HostScope::calls()) {
    if (host->progress) host->progress(progress);
    return;
  }
  if (quiet_) return;
  if (terminal_) {
    show_bar(progress);
  } else {
    show_line(progress);
  }
}

void ProgressDisplay::show_bar(const SolverProgress& progress) {
  constexpr int width = 30;
  double fraction = progress.fraction;
  if (progress.phase == "sweep" && progress.estimated_error > 0) {
    // Errors fall by a factor a sweep: the way from the first to the tolerance is even in their logarithm.
    if (first_error_ <= 0) first_error_ = progress.estimated_error;
    if (first_error_ > tolerance_) {
      fraction = std::log(first_error_ / progress.estimated_error) / std::log(first_error_ / tolerance_);
    }
    shown_fraction_ = std::max(shown_fraction_, std::clamp(fraction, 0.0, 1.0));
    fraction = shown_fraction_;
  }
  const int filled = static_cast<int>(std::lround(width * std::clamp(fraction, 0.0, 1.0)));
  std::string text = fmt::format("\r{:<7}[{}{}]", progress.phase, std::string(static_cast<std::size_t>(filled), '#'),
                                 std::string(static_cast<std::size_t>(width - filled), '.'));
  if (progress.phase == "sweep") {
    text += fmt::format(" {:3}  error {:.1e}  energy {:.1e}", progress.sweep, progress.estimated_error,
                        progress.energy_residual);
  }
  tell("{}\x1b[K", text);
  std::fflush(stderr);
  bar_open_ = true;
}

void ProgressDisplay::show_line(const SolverProgress& progress) {
  if (progress.phase == "sweep") {
    tell("sweep {}: estimated error {:.2e}, energy residual {:.2e}\n", progress.sweep, progress.estimated_error,
         progress.energy_residual);
  } else if (progress.phase != last_phase_) {
    tell("{}\n", progress.phase);
  }
  last_phase_ = progress.phase;
}

}  // namespace cloudbow
