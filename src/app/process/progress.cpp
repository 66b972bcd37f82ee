#include "app/process/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "app/process/host.hpp"
#include "app/process/messages.hpp"

namespace cloudbow {

namespace {

constexpr double least_elapsed_seconds = 2, least_fraction = 0.01;

/// Predicted seconds of a solve that are done and that are left.
struct Work {
  double done;
  double left;
};

/// @param fraction of the way to the tolerance
Work work_of_sweeps(const SolveSeconds& phases, int sweeps, double fraction) {
  const double left = (1 - fraction) * std::max(phases.sweeps, static_cast<double>(sweeps));
  return {phases.before_sweeps + sweeps * phases.sweep, left * phases.sweep + phases.after_sweeps};
}

Work work_of(const SolveSeconds& phases, const SolverProgress& progress, double fraction) {
  if (progress.phase == "tables" || progress.phase == "beam") return {0, phases.total()};
  if (progress.phase == "sweep") return work_of_sweeps(phases, progress.sweep, fraction);
  if (progress.phase == "gather") {
    const double before = work_of_sweeps(phases, progress.sweep, 1).done;
    return {before + fraction * phases.after_sweeps, (1 - fraction) * phases.after_sweeps};
  }
  return {fraction * phases.total(), (1 - fraction) * phases.total()};
}

}  // namespace

void RunClock::finish_solve() {
  if (finished_ < solves_.size()) done_ += solves_[finished_++];
  phases_.reset();
}

std::optional<double> RunClock::seconds_left(const SolverProgress& progress, double fraction, Time now) {
  if (!start_ && progress.phase != "tables") start_ = now;
  if (!start_ || finished_ == solves_.size()) return std::nullopt;
  const double solve = solves_[finished_];
  const double inside = std::clamp(fraction, 0., 1.);
  Work work{inside * solve, (1 - inside) * solve};
  if (phases_) {
    work = work_of(*phases_, progress, inside);
    work.left += std::max(0., solve - phases_->total());
  }
  for (std::size_t later = finished_ + 1; later < solves_.size(); ++later) work.left += solves_[later];
  work.done += done_;
  const double elapsed = std::chrono::duration<double>(now - *start_).count();
  if (elapsed < least_elapsed_seconds || work.done <= least_fraction * (work.done + work.left)) return std::nullopt;
  return elapsed / work.done * work.left;
}

std::string time_left_text(double seconds) {
  const auto whole = std::lround(seconds);
  if (whole < 60) return fmt::format("{} s left", whole);
  const auto minutes = std::lround(seconds / 60);
  if (minutes < 60) return fmt::format("{} min left", minutes);
  return fmt::format("{} h {} min left", minutes / 60, minutes % 60);
}

ProgressDisplay::ProgressDisplay(bool quiet, double tolerance, RunClock* clock)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1), tolerance_(tolerance), clock_(clock) {}

ProgressDisplay::~ProgressDisplay() {
  if (clock_ != nullptr) clock_->finish_solve();
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
  constexpr int width = 20;
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
  if (const auto left = clock_ != nullptr ? clock_->seconds_left(progress, fraction) : std::nullopt)
    text += "  " + time_left_text(*left);
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
