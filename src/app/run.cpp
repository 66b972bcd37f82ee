#include "cloudbow/app/run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>

#include "cloudbow/app/assemble.hpp"
#include "cloudbow/app/interrupt.hpp"
#include "cloudbow/app/progress.hpp"
#include "cloudbow/app/scene.hpp"
#include "cloudbow/app/version.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/results/result_file.hpp"
#include "cloudbow/results/summary.hpp"
#include "history.hpp"

namespace cloudbow {
namespace {

std::filesystem::path output_file(const RunOptions& options, const Scene& scene) {
  if (!options.output.empty()) return options.output;
  if (!scene.output.file.empty()) return scene.output.file;
  return scene.path.stem().string() + ".h5";
}

void check_not_an_input(const std::filesystem::path& output, const Scene& scene) {
  for (const std::filesystem::path& input : scene.inputs) {
    std::error_code error;
    if (std::filesystem::equivalent(output, input, error)) {
      throw InputError(
          fmt::format("{}: the result would overwrite what it is made from (found the same file as {}, "
                      "allowed any other)",
                      output.string(), input.string()));
    }
  }
}

std::string classes_text(const PhaseClassReport& classes) {
  return fmt::format("{} of {} functions, which changes fluxes by about {:.1e} of the incident", classes.classes,
                     classes.functions, classes.estimated_error);
}

void print_prediction(const AssembledScene& scene, std::size_t memory, std::uint64_t available) {
  const OpticalGrid& grid = scene.problem.grid;
  fmt::print("grid      {} x {} columns, {} levels, {} cells with matter\n", grid.box.nx, grid.box.ny, grid.box.nz(),
             grid.active_cells());
  fmt::print("solver    {} control points, {}, tolerance {}\n", scene.options.control_points, scene.options.directions,
             scene.options.tolerance);
  if (scene.phase_classes) fmt::print("phase     {}\n", classes_text(*scene.phase_classes));
  fmt::print("memory    {:.2f} GB predicted, {:.1f} GB there\n", static_cast<double>(memory) / 1e9,
             static_cast<double>(available) / 1e9);
  fmt::print("time      {:.1f} s predicted\n", predict_seconds(scene.problem, scene.options));
}

}  // namespace

std::uint64_t physical_memory_bytes() {
  auto bytes = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  std::ifstream group("/sys/fs/cgroup/memory.max");
  if (std::uint64_t limit = 0; group >> limit && limit > 0) bytes = std::min(bytes, limit);
  return bytes;
}

int run(const RunOptions& options) {
  const Scene scene = read_scene(options.scene, options.overrides);
  const std::filesystem::path output = output_file(options, scene);
  check_not_an_input(output, scene);
  if (!options.dry_run) check_writable(output);

  const std::uint64_t available = physical_memory_bytes();
  AssembledScene assembled = assemble(scene, available);
  assembled.options.threads = options.threads;
  const std::size_t memory = predict_memory(assembled.problem, assembled.options);
  if (memory > available) {
    throw InputError(
        fmt::format("{}: needs more memory than this machine has (found {:.1f} GB needed, allowed {:.1f} "
                    "GB); a smaller domain, fewer solver.control_points or a lower solver.accuracy need "
                    "less",
                    scene.path.string(), static_cast<double>(memory) / 1e9, static_cast<double>(available) / 1e9));
  }
  if (options.dry_run) {
    print_prediction(assembled, memory, available);
    return kExitDone;
  }

  const InterruptGuard guard;
  Solution solution;
  {
    ProgressDisplay display(options.quiet, assembled.options.tolerance);
    solution = solve(assembled.problem, assembled.options, [&display](const SolverProgress& progress) {
      InterruptGuard::check();
      display.show(progress);
    });
  }
  InterruptGuard::check();
  ResultInfo info{scene.title, fmt::format("cloudbow {}", version()), history_line(options.command), scene.text};
  if (assembled.phase_classes) {
    info.phase_classes = assembled.phase_classes->classes;
    info.phase_class_error = assembled.phase_classes->estimated_error;
  }
  write_result(output, solution, info);
  InterruptGuard::check();

  if (!options.quiet && assembled.phase_classes) {
    fmt::print("{:<21}{}\n", "phase functions", classes_text(*assembled.phase_classes));
  }
  if (!options.quiet) fmt::print("{}\nwritten to {}\n", summary_table(solution), output.string());
  if (!solution.report.converged) {
    fmt::print(stderr,
               "cloudbow: not converged: estimated error {:.2e} after {} sweeps, energy residual {:.2e}; {} is "
               "marked so\n",
               solution.report.estimated_error, solution.report.sweeps, solution.ledger.residual, output.string());
    return kExitNotConverged;
  }
  return kExitDone;
}

}  // namespace cloudbow
