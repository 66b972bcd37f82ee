#include "app/planning/solve_scenes.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "app/planning/coarse_solves.hpp"
#include "app/planning/error_calibration.hpp"
#include "app/planning/run_checkpoints.hpp"
#include "app/planning/solve_share.hpp"
#include "app/process/interrupt.hpp"
#include "app/process/messages.hpp"
#include "app/process/progress.hpp"
#include "cloudbow/transport/solve_seconds.hpp"
#include "cloudbow/transport/solver.hpp"

namespace cloudbow {

ErrorEstimate estimate_of(const Scene& scene, const PlannedScene& planned, const Solution& solution, CellLight light,
                          Ranks* ranks) {
  const CoarseSolves coarse_solves = solve_coarsely(
      planned.plan, planned.coarse(), planned.as, [](const SolverProgress&) { InterruptGuard::check(); },
      std::move(light), ranks);
  if (ranks != nullptr && !ranks->is_first()) return {};
  ErrorEstimate error =
      estimate_error(solution, coarse_solves, error_weights(scene.solver.accuracy, planned.as), scene.output.errors);
  error.calibrated_for = scene.solver.accuracy;
  return error;
}

namespace {

/// One wavelength of a run.
SolveResult solve_scene(const Scene& scene, PlannedScene planned, std::size_t number, std::size_t scenes,
                        const RunOptions& options, RunClock& clock) {
  const AssembledScene& assembled = *planned.scene;
  Ranks* const together = options.share ? options.share->together() : nullptr;
  if (scene.wavelength_um && !options.quiet) tell("wavelength {} um\n", *scene.wavelength_um);
  const auto solve_shown = [&](const SolvePlan& plan, const SolveMeans& means) {
    const bool is_main = &plan == &planned.plan;
    if (is_main) clock.begin_solve(predict_phases(plan));
    ProgressDisplay display(options.quiet, plan.options().tolerance, is_main ? &clock : nullptr);
    // Between sweeps a signal waits for the checkpoint.
    const bool kept = means.checkpoints != nullptr && !options.checkpoint.empty();
    return solve(
        plan,
        [&display, kept](const SolverProgress& progress) {
          if (!kept || progress.phase != "sweep") InterruptGuard::check();
          display.show(progress);
        },
        means);
  };
  std::optional<RunCheckpoints> checkpoints;
  if (!options.checkpoint.empty() || !options.resume.empty()) checkpoints.emplace(options, number, scenes);
  CellLight light;
  SolveResult result{solve_shown(planned.plan, {.checkpoints = checkpoints ? &*checkpoints : nullptr,
                                                .ranks = together,
                                                .light = scene.output.error_estimate ? &light : nullptr})};
  if (together != nullptr && !together->is_first()) {
    if (scene.output.error_estimate) estimate_of(scene, planned, result.solution, std::move(light), together);
    return result;
  }
  if (checkpoints && !checkpoints->used() && number == 0 && !options.quiet) {
    tell("cloudbow: {} not used: the columns of this scene are solved without iteration\n",
         options.checkpoint.empty() ? "--resume is"
         : options.resume.empty()   ? "--checkpoint is"
                                    : "--checkpoint and --resume are");
  }
  if (scene.output.error_estimate)
    result.error = estimate_of(scene, planned, result.solution, std::move(light), together);
  if (options.compare) {
    // A single column is its own independent column.
    const bool alone = assembled.one_column && !assembled.options.beam_crosses_columns;
    if (!options.quiet && !alone) tell("independent columns\n");
    result.independent_columns =
        alone ? result.solution : solve_shown(planned.plan.with(with_independent_columns(assembled.options)), {});
  }
  result.cloud_optical_depth = assembled.cloud_optical_depth;
  result.cloud_extinction = assembled.cloud_extinction;
  result.clouds = assembled.clouds;
  result.phase_classes = assembled.phase_classes;
  InterruptGuard::check();
  return result;
}

}  // namespace

Solved solve_all(const std::vector<Scene>& scenes, CostEstimate cost, const RunOptions& options,
                 std::uint64_t available, CloudFiles& files) {
  Solved solved;
  std::vector<double> seconds_here;
  for (std::size_t n = 0; n < scenes.size(); ++n) {
    if (options.share == nullptr || options.share->has(n)) seconds_here.push_back(cost.solve_seconds[n]);
  }
  RunClock clock(std::move(seconds_here));
  for (std::size_t n = 0; n < scenes.size(); ++n) {
    const Scene& scene = scenes[n];
    std::optional<SolveResult> result = shared_solve(options.share.get(), n, [&] {
      PlannedScene planned =
          cost.only ? std::move(*cost.only) : plan_scene(scene, available, files, cost.levels_m, options.threads);
      return solve_scene(scene, std::move(planned), n, scenes.size(), options, clock);
    });
    if (!result) continue;
    solved.solutions.push_back(std::move(result->solution));
    if (result->error) solved.errors.push_back(std::move(*result->error));
    if (result->independent_columns) solved.independent_columns.push_back(std::move(*result->independent_columns));
    if (scene.output.optical_depth) solved.cloud_optical_depth.push_back(std::move(result->cloud_optical_depth));
    if (scene.output.extinction) solved.cloud_extinction.push_back(std::move(result->cloud_extinction));
    solved.clouds.push_back(std::move(result->clouds));
    if (result->phase_classes) solved.phase_classes.push_back(*result->phase_classes);
  }
  return solved;
}

}  // namespace cloudbow
