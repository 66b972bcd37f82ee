#include "app/planning/target_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "app/planning/error_calibration.hpp"
#include "app/process/messages.hpp"
#include "app/scene/accuracy.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::vector<Scene> scenes_at(const RunOptions& options, const std::string& level) {
  std::vector<std::string> overrides = options.overrides;
  overrides.push_back("solver.accuracy=" + level);
  std::vector<Scene> scenes = read_scenes(options.scene, overrides);
  for (Scene& scene : scenes) scene.output.error_estimate = true;
  return scenes;
}

/// Error of the fluxes that the target names; of a spectrum the largest.
double error_of(const std::vector<ErrorEstimate>& errors, ErrorOf of) {
  double largest = 0;
  for (const ErrorEstimate& error : errors)
    largest = std::max(largest, of == ErrorOf::domain ? error.domain.total() : error.columns());
  return largest;
}

double expected_error(const std::vector<ErrorEstimate>& known, ErrorOf of, const ByFlux& ratio) {
  double largest = 0;
  for (const ErrorEstimate& error : known) {
    largest = std::max(largest, of == ErrorOf::domain
                                    ? ratio.domain * error.domain.total()
                                    : std::max(ratio.up * error.up.total(), ratio.down * error.down.total()));
  }
  return largest;
}

ByFlux operator/(const ByFlux& a, const ByFlux& b) { return {a.domain / b.domain, a.up / b.up, a.down / b.down}; }

// A draft does not subdivide thick voxels. Of levels that do it expected up to 4.5 times the error that `balanced`
// expects (docs/accuracy.md). Targets further away are refused at once.
constexpr double most_doubt = 5;

/// Time that the cost estimate omits, and that a second run does not need either.
double table_seconds(const Solved& solved) {
  double sum = 0;
  for (const Solution& solution : solved.solutions) sum += solution.report.seconds_tables;
  for (const ErrorEstimate& error : solved.errors) sum += error.table_seconds;
  return sum;
}

class TargetRunner {
 public:
  TargetRunner(const RunOptions& options, std::uint64_t available, CloudFiles& files)
      : options_(options), target_(*options.target), available_(available), files_(files), names_(accuracy_names()) {}

  TargetRun run() {
    std::size_t level = 0;
    begin_costs();
    solve_level(level);
    if (!reached() || !target_.error) {
      extend_costs();
      if (refuses_in_doubt()) level = solve_next_level(level);
      if (level == 0 || !reached()) {
        const std::size_t chosen = choose_level(levels_, target_, resources());
        if (chosen > level) {
          level = chosen;
          tell_choice(level);
          solve_level(level);
        }
      }
    }
    while (!reached()) {
      const auto next = next_level(levels_, level, target_, resources());
      if (!next) break;
      level = *next;
      tell_choice(level);
      solve_level(level);
    }
    finish(level);
    return std::move(result_);
  }

 private:
  Resources resources() const { return {seconds_since(start_), static_cast<double>(available_)}; }

  /// By the estimate of the last level solved.
  bool reached() const { return !target_.error || error_of(result_.solved.errors, target_.of) <= *target_.error; }

  LevelCost cost_of(const std::string& level) {
    const CostEstimate expected =
        estimate_cost(scenes_at(options_, level), available_, options_.threads, false, files_);
    return {level, 0, expected.seconds, static_cast<double>(expected.memory)};
  }

  /// A time too short for any level is reported before anything is solved.
  void begin_costs() {
    levels_ = {cost_of(names_.front())};
    first_seconds_ = levels_.front().seconds;
    choose_level(levels_, {std::nullopt, target_.of, target_.budget_seconds.value_or(1e30)}, resources());
  }

  void extend_costs() {
    const double pace = result_.report.seconds / first_seconds_;
    for (std::size_t n = 1; n < names_.size(); ++n) {
      LevelCost level = cost_of(names_[n]);
      level.seconds *= pace;
      levels_.push_back(level);
    }
    levels_.front().seconds = 0;  // it is there already
    expect_errors(0);
  }

  /// From the estimate of the level solved last.
  void expect_errors(std::size_t solved) {
    const std::vector<ErrorEstimate>& known = result_.solved.errors;
    const ByFlux ratio_of_known = error_ratio_to_draft(names_[solved], solved_as_);
    levels_[solved].error = error_of(known, target_.of);
    for (std::size_t n = solved + 1; n < names_.size(); ++n) {
      const ByFlux ratio = error_ratio_to_draft(names_[n], solved_as_) / ratio_of_known;
      levels_[n].error = expected_error(known, target_.of, ratio);
    }
  }

  bool refuses_in_doubt() const {
    if (!target_.error) return false;
    double least = levels_.front().error;
    for (const LevelCost& level : levels_) least = std::min(least, level.error);
    return least > *target_.error && least <= most_doubt * *target_.error;
  }

  /// Expects the errors of further levels anew. @returns the level solved last.
  std::size_t solve_next_level(std::size_t level) {
    const auto next = next_level(levels_, level, target_, resources());
    if (!next) return level;
    tell_choice(*next);
    solve_level(*next);
    expect_errors(*next);
    return *next;
  }

  void solve_level(std::size_t level) {
    result_.scenes = scenes_at(options_, names_[level]);
    result_.solved = {};
    CostEstimate expected = estimate_cost(result_.scenes, available_, options_.threads, false, files_);
    if (expected.only) solved_as_ = expected.only->as;
    const auto start = Clock::now();
    result_.solved = solve_all(result_.scenes, std::move(expected), options_, available_, files_);
    result_.report.seconds = seconds_since(start) - table_seconds(result_.solved);
    result_.report.levels_solved += (level == 0 ? "" : ", ") + names_[level];
    if (!options_.quiet) {
      tell("cloudbow: `{}`: estimated error of {} {}, in {:.2g} s\n", names_[level], name_of(target_.of),
           percent(error_of(result_.solved.errors, target_.of)), result_.report.seconds);
    }
  }

  void tell_choice(std::size_t level) const {
    if (options_.quiet) return;
    std::string wish;
    if (target_.error) wish = fmt::format("{} wanted", percent(*target_.error));
    if (target_.budget_seconds)
      wish += fmt::format("{}{:.3g} s of {:.3g} s left", wish.empty() ? "" : ", ",
                          *target_.budget_seconds - resources().spent_seconds, *target_.budget_seconds);
    tell("cloudbow: chose `{}`: {} of {} expected, in {:.2g} s and {:.2g} GB ({})\n", names_[level],
         percent(levels_[level].error), name_of(target_.of), levels_[level].seconds, levels_[level].memory_bytes / 1e9,
         wish);
  }

  void finish(std::size_t level) {
    TargetReport& report = result_.report;
    report.target_error = target_.error;
    report.of = name_of(target_.of);
    report.budget_seconds = target_.budget_seconds;
    report.accuracy = names_[level];
    report.predicted_error = levels_[level].error;
    report.predicted_seconds = level == 0 ? first_seconds_ : levels_[level].seconds;
    report.predicted_memory_bytes = levels_[level].memory_bytes;
    report.seconds_in_all = seconds_since(start_);
    report.met = reached() && (!target_.budget_seconds || report.seconds_in_all <= *target_.budget_seconds);
  }

  const RunOptions& options_;
  const Target target_;
  std::uint64_t available_;
  CloudFiles& files_;
  const std::vector<std::string> names_;
  const Clock::time_point start_ = Clock::now();
  std::vector<LevelCost> levels_;
  double first_seconds_ = 0;
  SolvedAs solved_as_ = SolvedAs::field;
  TargetRun result_;
};

}  // namespace

TargetRun reach_target(const RunOptions& options, std::uint64_t available, CloudFiles& files) {
  for (const std::string& setting : options.overrides) {
    if (setting.starts_with("solver.accuracy="))
      throw InputError(
          fmt::format("--set {}: --target-error and --budget choose the level (allowed: one or the other)", setting));
  }
  return TargetRunner(options, available, files).run();
}

}  // namespace cloudbow
