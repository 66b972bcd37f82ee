#include "app/process/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "app/process/host.hpp"
#include "app/process/messages.hpp"

namespace cloudbow {

namespace {

constexpr double least_elapsed_seconds = 2, least_fraction = 0.03;

struct Share {
  const char* phase;
  double from, to;
};
/// Of a solve of a field of clouds with few cameras: the order is right, the parts are rough.
constexpr std::array<Share, 4> shares{
    {{"tables", 0, 0.05}, {"beam", 0.05, 0.1}, {"sweep", 0.1, 0.6}, {"gather", 0.6, 1}}};

}  // namespace

std::optional<double> RunClock::seconds_left(double elapsed_seconds, double fraction) {
  if (elapsed_seconds < least_elapsed_seconds || fraction < least_fraction) return std::nullopt;
  return elapsed_seconds * (1 - std::min(fraction, 1.)) / fraction;
}

std::optional<double> RunClock::seconds_left(double fraction) const {
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  return seconds_left(elapsed.count(), (static_cast<double>(finished_) + fraction) / static_cast<double>(solves_));
}

std::string time_left_text(double seconds) {
  const auto whole = std::lround(seconds);
  if (whole < 60) return fmt::format("{} s left", whole);
  const auto minutes = std::lround(seconds / 60);
  if (minutes < 60) return fmt::format("{} min left", minutes);
  return fmt::format("{} h {} min left", minutes / 60, minutes % 60);
}

double solve_fraction(const std::string& phase, double fraction) {
  const auto share = std::ranges::find(shares, phase, &Share::phase);
  const double inside = std::clamp(fraction, 0., 1.);
  return share == shares.end() ? inside : share->from + inside * (share->to - share->from);
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
  const double done = solve_fraction(progress.phase, fraction);
  if (const auto left = clock_ != nullptr ? clock_->seconds_left(done) : std::nullopt)
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
