#include "cloudbow/app/run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <optional>

#include "cloudbow/app/assemble.hpp"
#include "cloudbow/app/cloud_files.hpp"
#include "cloudbow/app/interrupt.hpp"
#include "cloudbow/app/progress.hpp"
#include "cloudbow/app/scene.hpp"
#include "cloudbow/app/version.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/results/result_file.hpp"
#include "cloudbow/results/summary.hpp"
#include "cloudbow/transport/columns.hpp"
#include "history.hpp"

namespace cloudbow {
namespace {

std::filesystem::path output_file(const RunOptions& options, const Scene& scene) {
  if (!options.output.empty()) return options.output;
  if (!scene.output.file.empty()) return scene.output.file;
  return scene.path.stem().string() + ".h5";
}

std::string classes_text(const PhaseClassReport& classes) {
  return fmt::format("{} of {} functions, which changes fluxes by about {:.1e} of the incident", classes.classes,
                     classes.functions, classes.estimated_error);
}

/// What is known of a run before the first solve.
struct Forecast {
  std::size_t memory = 0;              ///< bytes, of the most demanding wavelength, with the results of all
  double seconds = 0;                  ///< of all wavelengths
  std::vector<double> levels_m;        ///< that serve all wavelengths; empty: there is one scene only
  std::optional<AssembledScene> only;  ///< that scene
};

/// Of the fields that a solution holds.
std::size_t solution_bytes(const AssembledScene& scene) {
  const BoxGrid& box = scene.problem.grid.box;
  const SolverOptions& options = scene.options;
  const std::size_t levels = options.flux_levels == FluxLevels::all          ? box.z_edge_m.size()
                             : options.flux_levels == FluxLevels::boundaries ? 2
                                                                             : options.listed_levels.size();
  const std::size_t of_cells = (options.absorption ? 1 : 0) + (options.actinic ? 1 : 0);
  std::size_t floats = box.columns() * (3 * levels + of_cells * static_cast<std::size_t>(box.nz()));
  for (const View& view : options.views) floats += std::max<std::size_t>(box.columns(), 1UL * view.width * view.height);
  for (const Camera& camera : options.cameras) floats += 1UL * camera.width * camera.height;
  if (options.radiance_field)
    floats += scene.problem.grid.active_cells() * static_cast<std::size_t>(options.control_points + 3);
  return floats * sizeof(float);
}

/// The radiance field of all wavelengths has one list of cells.
void check_same_cells(const std::vector<Scene>& scenes, std::uint64_t available, CloudFiles& files,
                      const std::vector<double>& levels_m) {
  std::optional<std::size_t> cells;
  for (const Scene& scene : scenes) {
    const std::size_t here = assemble(scene, available, files, levels_m).problem.grid.active_cells();
    if (here != cells.value_or(here)) {
      throw InputError(
          fmt::format("{}: a radiance field needs the same cells at every wavelength (found {} cells with "
                      "matter at {} um and {} at {} um, allowed optical depths that are above 0 at all or at none)",
                      scene.path.string(), *cells, *scenes.front().wavelength_um, here, *scene.wavelength_um));
    }
    cells = here;
  }
}

/// The same columns, each by itself, and their fluxes alone.
SolverOptions by_columns(SolverOptions options) {
  options.independent_columns = true;
  options.beam_crosses_columns = false;
  options.absorption = options.actinic = options.radiance_field = false;
  options.views.clear();
  options.cameras.clear();
  return options;
}

void check_comparable(const Scene& scene) {
  if (scene.solver.mode == SolveMode::independent_columns) {
    throw InputError(
        fmt::format("{}: --compare sets a solution beside independent columns (found independent-columns "
                    "itself, allowed auto, 3d)",
                    scene.where("solver.mode")));
  }
}

/// Looks at every wavelength, so that none fails after others were solved.
Forecast forecast(const std::vector<Scene>& scenes, std::uint64_t available, int threads, bool compare,
                  CloudFiles& files) {
  Forecast forecast;
  std::vector<std::vector<double>> levels;
  std::size_t kept = 0;
  for (const Scene& scene : scenes) {
    AssembledScene assembled = assemble(scene, available, files, {});
    assembled.options.threads = threads;
    forecast.memory = std::max(forecast.memory, predict_memory(assembled.problem, assembled.options));
    forecast.seconds += predict_seconds(assembled.problem, assembled.options);
    if (compare) {
      const SolverOptions columns = by_columns(assembled.options);
      forecast.memory = std::max(forecast.memory, predict_memory(assembled.problem, columns));
      forecast.seconds += predict_seconds(assembled.problem, columns);
      kept += solution_bytes(assembled);  // at most: of these, fluxes alone are kept
    }
    levels.push_back(assembled.problem.grid.box.z_edge_m);
    kept += solution_bytes(assembled);
    if (scenes.size() == 1) forecast.only = std::move(assembled);
  }
  if (scenes.size() > 1 || compare) forecast.memory += kept;
  if (scenes.size() > 1) {
    forecast.levels_m = finest_levels(levels);
    if (scenes.front().output.radiance_field) check_same_cells(scenes, available, files, forecast.levels_m);
  }
  return forecast;
}

void check_memory(const Scene& scene, const Forecast& forecast, std::uint64_t available) {
  if (forecast.memory <= available) return;
  throw InputError(fmt::format(
      "{}: needs more memory than this machine has (found {:.1f} GB needed, allowed {:.1f} "
      "GB); a smaller domain, fewer solver.control_points or a lower solver.accuracy need "
      "less",
      scene.path.string(), static_cast<double>(forecast.memory) / 1e9, static_cast<double>(available) / 1e9));
}

void print_forecast(const std::vector<Scene>& scenes, const AssembledScene& first, const Forecast& forecast,
                    std::uint64_t available) {
  const OpticalGrid& grid = first.problem.grid;
  fmt::print("grid      {} x {} columns, {} levels, {} cells with matter\n", grid.box.nx, grid.box.ny, grid.box.nz(),
             grid.active_cells());
  if (solved_without_azimuths(first.problem, first.options)) {
    fmt::print("solver    columns by themselves, {} polar directions a hemisphere\n", first.options.column_streams);
  } else {
    fmt::print("solver    {} control points, {}, tolerance {}\n", first.options.control_points,
               first.options.directions, first.options.tolerance);
  }
  if (scenes.front().wavelength_um) {
    std::string list;
    for (const Scene& scene : scenes) list += fmt::format("{}{}", list.empty() ? "" : ", ", *scene.wavelength_um);
    fmt::print("spectrum  {} um\n", list);
  }
  if (first.phase_classes) fmt::print("phase     {}\n", classes_text(*first.phase_classes));
  fmt::print("memory    {:.2f} GB predicted, {:.1f} GB there\n", static_cast<double>(forecast.memory) / 1e9,
             static_cast<double>(available) / 1e9);
  fmt::print("time      {:.1f} s predicted\n", forecast.seconds);
}

/// Solutions of all wavelengths, and what the result file says about how they were made.
struct Solved {
  std::vector<Solution> solutions;
  std::vector<Solution> by_columns;             ///< of each the same as independent columns, or none
  std::vector<PhaseClassReport> phase_classes;  ///< of each, or none
};

Solved solve_all(const std::vector<Scene>& scenes, Forecast forecast, const RunOptions& options,
                 std::uint64_t available, CloudFiles& files) {
  Solved solved;
  for (const Scene& scene : scenes) {
    AssembledScene assembled =
        forecast.only ? std::move(*forecast.only) : assemble(scene, available, files, forecast.levels_m);
    assembled.options.threads = options.threads;
    if (scene.wavelength_um && !options.quiet) fmt::print(stderr, "wavelength {} um\n", *scene.wavelength_um);
    const auto solve_shown = [&](const SolverOptions& how) {
      ProgressDisplay display(options.quiet, how.tolerance);
      return solve(assembled.problem, how, [&display](const SolverProgress& progress) {
        InterruptGuard::check();
        display.show(progress);
      });
    };
    solved.solutions.push_back(solve_shown(assembled.options));
    if (options.compare) {
      if (!options.quiet) fmt::print(stderr, "independent columns\n");
      solved.by_columns.push_back(solve_shown(by_columns(assembled.options)));
    }
    if (assembled.phase_classes) solved.phase_classes.push_back(*assembled.phase_classes);
    InterruptGuard::check();
  }
  return solved;
}

void print_summaries(const std::vector<Scene>& scenes, const Solved& solved) {
  for (std::size_t n = 0; n < scenes.size(); ++n) {
    if (scenes[n].wavelength_um)
      fmt::print("{}{:<21}{} um\n", n == 0 ? "" : "\n", "wavelength", *scenes[n].wavelength_um);
    if (!solved.phase_classes.empty())
      fmt::print("{:<21}{}\n", "phase functions", classes_text(solved.phase_classes[n]));
    fmt::print("{}", summary_table(solved.solutions[n]));
    if (!solved.by_columns.empty()) {
      const EnergyLedger &ledger = solved.solutions[n].ledger, &columns = solved.by_columns[n].ledger;
      fmt::print("{:<21}reflectance {:+.6f}, transmittance {:+.6f}\n", "minus columns",
                 ledger.reflectance - columns.reflectance, ledger.transmittance - columns.transmittance);
    }
  }
}

/// Exit code.
int tell_unconverged(const std::vector<Scene>& scenes, const std::vector<Solution>& solutions, const std::string& which,
                     const std::filesystem::path& output) {
  int code = kExitDone;
  for (std::size_t n = 0; n < solutions.size(); ++n) {
    const Solution& solution = solutions[n];
    if (solution.report.converged) continue;
    const std::string at = which + (scenes[n].wavelength_um ? fmt::format(" at {} um", *scenes[n].wavelength_um) : "");
    fmt::print(stderr,
               "cloudbow: not converged{}: estimated error {:.2e} after {} sweeps, energy residual {:.2e}; {} is "
               "marked so\n",
               at, solution.report.estimated_error, solution.report.sweeps, solution.ledger.residual, output.string());
    code = kExitNotConverged;
  }
  return code;
}

}  // namespace

std::uint64_t physical_memory_bytes() {
  auto bytes = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  std::ifstream group("/sys/fs/cgroup/memory.max");
  if (std::uint64_t limit = 0; group >> limit && limit > 0) bytes = std::min(bytes, limit);
  return bytes;
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

std::size_t foreseen_memory(const std::vector<Scene>& scenes, std::uint64_t available, int threads) {
  CloudFiles files(scenes.size() > 1);
  return forecast(scenes, available, threads, false, files).memory;
}

int run(const RunOptions& options) {
  const std::vector<Scene> scenes = read_scenes(options.scene, options.overrides);
  const Scene& first = scenes.front();
  const std::filesystem::path output = output_file(options, first);
  check_not_an_input(output, first);
  if (options.compare) check_comparable(first);
  if (!options.dry_run) check_writable(output);

  const std::uint64_t available = physical_memory_bytes();
  CloudFiles files(scenes.size() > 1);
  Forecast expected = forecast(scenes, available, options.threads, options.compare, files);
  check_memory(first, expected, available);
  if (options.dry_run) {
    const AssembledScene assembled =
        expected.only ? std::move(*expected.only) : assemble(first, available, files, expected.levels_m);
    print_forecast(scenes, assembled, expected, available);
    return kExitDone;
  }

  const InterruptGuard guard;
  const Solved solved = solve_all(scenes, std::move(expected), options, available, files);
  ResultInfo info{first.title, fmt::format("cloudbow {}", version()), history_line(options.command), first.text};
  for (const PhaseClassReport& classes : solved.phase_classes) {
    info.phase_classes.push_back(classes.classes);
    info.phase_class_error.push_back(classes.estimated_error);
  }
  for (const Scene& scene : scenes) {
    if (scene.wavelength_um) info.wavelengths_um.push_back(*scene.wavelength_um);
  }
  write_result(output, solved.solutions, info, solved.by_columns);
  InterruptGuard::check();

  if (!options.quiet) {
    print_summaries(scenes, solved);
    fmt::print("\nwritten to {}\n", output.string());
  }
  return std::max(tell_unconverged(scenes, solved.solutions, "", output),
                  tell_unconverged(scenes, solved.by_columns, " as independent columns", output));
}

}  // namespace cloudbow
