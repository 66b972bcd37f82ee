#include "solve_scenes.hpp"

#include <fmt/format.h>

#include <optional>

#include "cloudbow/app/error_calibration.hpp"
#include "cloudbow/app/interrupt.hpp"
#include "cloudbow/app/progress.hpp"
#include "companions.hpp"
#include "messages.hpp"
#include "run_checkpoints.hpp"

namespace cloudbow {
namespace {

ErrorEstimate estimate(const Scene& scene, const AssembledScene& assembled, const Solution& solution) {
  const SolvedAs as = solved_as(assembled.problem, assembled.options, assembled.one_column);
  const Companions companions = solve_companions(assembled.problem, assembled.options, scene.solver.accuracy, as,
                                                 [](const SolverProgress&) { InterruptGuard::check(); });
  ErrorEstimate error =
      estimate_error(solution, companions, error_weights(scene.solver.accuracy, as), scene.output.errors);
  error.calibrated_for = scene.solver.accuracy;
  return error;
}

}  // namespace

Solved solve_all(const std::vector<Scene>& scenes, Forecast forecast, const RunOptions& options,
                 std::uint64_t available, CloudFiles& files) {
  Solved solved;
  for (const Scene& scene : scenes) {
    AssembledScene assembled =
        forecast.only ? std::move(*forecast.only) : assemble(scene, available, files, forecast.levels_m);
    assembled.options.threads = options.threads;
    if (scene.wavelength_um && !options.quiet) tell("wavelength {} um\n", *scene.wavelength_um);
    const auto solve_shown = [&](const SolverOptions& how, Checkpoints* checkpoints) {
      ProgressDisplay display(options.quiet, how.tolerance);
      // Between sweeps a signal waits for the checkpoint.
      const bool kept = checkpoints != nullptr && !options.checkpoint.empty();
      return solve(
          assembled.problem, how,
          [&display, kept](const SolverProgress& progress) {
            if (!kept || progress.phase != "sweep") InterruptGuard::check();
            display.show(progress);
          },
          checkpoints);
    };
    std::optional<RunCheckpoints> checkpoints;
    if (!options.checkpoint.empty() || !options.resume.empty())
      checkpoints.emplace(options, solved.solutions.size(), scenes.size());
    solved.solutions.push_back(solve_shown(assembled.options, checkpoints ? &*checkpoints : nullptr));
    if (checkpoints && !checkpoints->used() && solved.solutions.size() == 1 && !options.quiet) {
      tell("cloudbow: {} not used: the columns of this scene are solved without iteration\n",
           options.checkpoint.empty() ? "--resume is"
           : options.resume.empty()   ? "--checkpoint is"
                                      : "--checkpoint and --resume are");
    }
    if (scene.output.error_estimate) solved.errors.push_back(estimate(scene, assembled, solved.solutions.back()));
    if (options.compare) {
      // A single column is its own independent column.
      const bool alone = assembled.one_column && !assembled.options.beam_crosses_columns;
      if (!options.quiet && !alone) tell("independent columns\n");
      solved.by_columns.push_back(alone ? solved.solutions.back()
                                        : solve_shown(by_columns(assembled.options), nullptr));
    }
    if (assembled.phase_classes) solved.phase_classes.push_back(*assembled.phase_classes);
    InterruptGuard::check();
  }
  return solved;
}

}  // namespace cloudbow
