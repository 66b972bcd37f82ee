#include "app/planning/tradeoff.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <system_error>

#include "app/planning/cost_estimate.hpp"
#include "app/process/child_run.hpp"
#include "app/process/exit_codes.hpp"
#include "app/process/interrupt.hpp"
#include "app/process/messages.hpp"
#include "app/scene/accuracy.hpp"
#include "cloudbow/app/scene.hpp"
#include "cloudbow/core/available_memory.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/output_files.hpp"
#include "cloudbow/io/boundary_result.hpp"
#include "cloudbow/plots/tradeoff_report.hpp"
#include "cloudbow/results/tradeoff.hpp"

namespace cloudbow {
namespace {

/// Levels that are modes of the solver, at the coarsest accuracy.
const std::vector<std::string> column_modes{"independent-columns", "independent-diffuse"};

bool is_column_mode(const std::string& level) {
  return std::find(column_modes.begin(), column_modes.end(), level) != column_modes.end();
}

/// Gone with everything in it.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "cloudbow-tradeoff-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw InputError(fmt::format("{}: can't be made ({}); TMPDIR names the folder for temporary results", name,
                                   std::generic_category().message(errno)));
    }
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

struct Level {
  std::string name;
  std::vector<std::string> overrides;  ///< the user's, then its own
};

Level make_level(const std::string& name, const TradeoffOptions& options) {
  Level level{name, options.overrides};
  if (is_column_mode(name)) {
    level.overrides.insert(level.overrides.end(),
                           {"solver.accuracy=" + accuracy_names().front(), "solver.mode=" + name});
  } else {
    level.overrides.push_back("solver.accuracy=" + name);
  }
  return level;
}

/// If they do not, the draft is the level of independent columns.
bool columns_exchange_light(const Scene& scene) {
  const bool one_column = scene.clouds.empty() && scene.albedo_map.empty();
  return !one_column &&
         (scene.solver.mode == SolveMode::automatic || scene.solver.mode == SolveMode::three_dimensional);
}

/// In the order of tradeoff_levels(), each once.
std::vector<Level> chosen_levels(const TradeoffOptions& options, const Scene& scene) {
  const std::vector<std::string> names = tradeoff_levels();
  for (const std::string& wanted : options.levels) {
    if (std::find(names.begin(), names.end(), wanted) == names.end())
      throw InputError(fmt::format("--levels: found '{}', allowed {}", wanted, fmt::join(names, ", ")));
  }
  std::vector<Level> levels;
  for (const std::string& name : names) {
    const bool asked = std::find(options.levels.begin(), options.levels.end(), name) != options.levels.end();
    const bool by_default = !is_column_mode(name) || columns_exchange_light(scene);
    if (options.levels.empty() ? by_default : asked) levels.push_back(make_level(name, options));
  }
  if (levels.size() < 2 && options.reference.empty()) {
    throw InputError(
        fmt::format("--levels: found {} alone, allowed two or more, or one with --reference", levels.front().name));
  }
  return levels;
}

void check_options(const TradeoffOptions& options, const Scene& scene) {
  for (const std::string& setting : options.overrides) {
    if (setting.starts_with("solver.accuracy="))
      throw InputError(fmt::format("--set {}: the levels are what is compared (allowed: --levels)", setting));
  }
  if (scene.output.flux_levels == FluxLevels::listed) {
    throw InputError(
        fmt::format("{}: errors are those of fluxes at top and bottom (found a list of heights, allowed "
                    "--set output.flux_levels=all or boundaries)",
                    scene.where("output.flux_levels")));
  }
  std::vector<std::filesystem::path> inputs = scene.inputs;
  inputs.push_back(options.reference);
  check_outputs({{options.csv, "the table", OutputKind::csv}, {options.plot, "the plot", OutputKind::plot}}, inputs);
}

/// Empty for a level that can be solved.
std::string why_left_out(const Level& level, const TradeoffOptions& options) {
  const std::uint64_t available = options.memory_bytes != 0 ? options.memory_bytes : available_memory_bytes();
  std::size_t needed = 0;
  try {
    needed = predicted_memory(read_scenes(options.scene, level.overrides), available, options.threads);
  } catch (const InputError& error) {
    // Independent columns lack some outputs that a scene may request. An error of the scene itself is reported at the
    // next level.
    if (!is_column_mode(level.name) || !options.levels.empty()) throw;
    return error.what();
  }
  if (needed <= available) return "";
  return fmt::format("needs {:.2f} GB, {:.2f} GB are available", static_cast<double>(needed) * 1e-9,
                     static_cast<double>(available) * 1e-9);
}

BoundaryResult solve_level(const Level& level, const TradeoffOptions& options, const ScratchFolder& scratch) {
  const std::filesystem::path file = scratch / (level.name + ".h5");
  std::vector<std::string> arguments{"run", options.scene.string(), "-o", file.string()};
  for (const std::string& setting : level.overrides) arguments.insert(arguments.end(), {"--set", setting});
  // Errors are against the truth of the table: an estimate would cost time and add nothing.
  arguments.insert(arguments.end(), {"--set", "output.error_estimate=false"});
  if (options.threads > 0) arguments.insert(arguments.end(), {"--threads", std::to_string(options.threads)});
  if (options.quiet) arguments.emplace_back("--quiet");
  if (!options.quiet) tell("level {}\n", level.name);
  const int code = run_child(arguments);
  InterruptGuard::check();
  if (code != exit_done && code != exit_not_converged)
    throw InputError(fmt::format("level {}: its run ended with exit code {}", level.name, code));
  BoundaryResult result = read_boundary_result(file);
  std::error_code error;
  std::filesystem::remove(file, error);
  return result;
}

}  // namespace

std::vector<std::string> tradeoff_levels() {
  std::vector<std::string> levels = accuracy_names();
  levels.insert(levels.begin(), column_modes.begin(), column_modes.end());
  return levels;
}

int tradeoff(const TradeoffOptions& options) {
  const Scene scene = read_scene(options.scene, options.overrides);
  check_options(options, scene);
  const std::vector<Level> levels = chosen_levels(options, scene);
  std::optional<BoundaryResult> truth;
  if (!options.reference.empty()) truth = read_boundary_result(options.reference);

  const InterruptGuard guard;
  const ScratchFolder scratch;
  TradeoffReport report;
  report.title = scene.title.empty() ? scene.path.stem().string() : scene.title;
  std::vector<BoundaryResult> results;
  for (const Level& level : levels) {
    if (const std::string reason = why_left_out(level, options); !reason.empty()) {
      report.notes.push_back(fmt::format("{:<20}left out: {}", level.name, reason));
      continue;
    }
    BoundaryResult result = solve_level(level, options, scratch);
    if (truth) flux_errors(result, *truth);  // reports a different grid before more expensive levels are solved
    report.rows.push_back({level.name, result.cost, {}});
    results.push_back(std::move(result));
  }
  if (results.empty()) {
    throw InputError(
        fmt::format("{}: no level can be solved ({})", options.scene.string(), fmt::join(report.notes, "; ")));
  }
  report.truth = truth ? options.reference.string() : report.rows.back().level;
  const BoundaryResult& exact = truth ? *truth : results.back();
  for (std::size_t n = 0; n < results.size(); ++n) {
    if (&results[n] != &exact) report.rows[n].errors = flux_errors(results[n], exact);
  }

  if (!options.csv.empty()) write_tradeoff_csv(options.csv, report);
  if (!options.plot.empty()) write_tradeoff_plot(options.plot, report);
  fmt::print("{}", tradeoff_table(report));
  const bool converged =
      std::all_of(results.begin(), results.end(), [](const BoundaryResult& r) { return r.cost.converged; });
  return converged ? exit_done : exit_not_converged;
}

}  // namespace cloudbow
