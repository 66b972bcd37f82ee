#include "app/planning/cost_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/planning/coarse_solves.hpp"
#include "app/verify/machine_speed.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/transport/output_fields.hpp"
#include "cloudbow/transport/solver.hpp"

namespace cloudbow {
namespace {

/// Memory of the fields that a solution holds.
std::size_t solution_bytes(const Scene& read, const AssembledScene& scene) {
  const BoxGrid& box = scene.problem.grid.box;
  const SolverOptions& options = scene.options;
  const std::size_t levels = flux_levels(box, options).size();
  const std::size_t of_cells =
      static_cast<std::size_t>(cell_field_count(options)) + (read.output.heating_rate ? 1U : 0U);
  const std::size_t of_levels = options.circumsolar_half_angle > 0 ? 4 : 3;
  std::size_t floats = box.columns() * (of_levels * levels + of_cells * static_cast<std::size_t>(box.nz()));
  for (const View& view : options.views) floats += std::max<std::size_t>(box.columns(), 1UL * view.width * view.height);
  for (const Camera& camera : options.cameras) floats += 1UL * camera.width * camera.height;
  if (options.radiance_field)
    floats += scene.problem.grid.active_cells() * static_cast<std::size_t>(options.control_points + 3);
  return (floats + scene.cloud_extinction.size()) * sizeof(float);
}

std::size_t predicted_bytes(const Scene& scene, const AssembledScene& assembled, const SolvePlan& plan, int ranks) {
  try {
    return predict_memory(plan, ranks) + assembled.cloud_extinction.size() * sizeof(float);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", scene.path.string(), error.what()));
  }
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

}  // namespace

std::string memory_text(std::size_t bytes) { return fmt::format("{:.3g} GB", static_cast<double>(bytes) / 1e9); }

std::string time_text(double seconds) {
  return seconds < 9.95 ? fmt::format("{:.2g} s", seconds) : fmt::format("{:.0f} s", seconds);
}

PlannedScene::PlannedScene(AssembledScene assembled, std::string level)
    : scene(std::make_shared<const AssembledScene>(std::move(assembled))),
      plan(scene->problem, scene->options),
      as(solved_as(plan, scene->one_column)),
      accuracy(std::move(level)) {}

SolvePlan PlannedScene::coarse() const { return coarse_plan(plan, accuracy, as); }

PlannedScene plan_scene(const Scene& scene, std::uint64_t available, CloudFiles& files,
                        const std::vector<double>& levels_m, int threads) {
  AssembledScene assembled = assemble(scene, available, files, levels_m);
  assembled.options.threads = threads;
  return {std::move(assembled), scene.solver.accuracy};
}

Scene as_solved(Scene scene) {
  if (scene.broadband && scene.broadband->method == SceneBroadband::Method::columns)
    scene.solver.mode = SolveMode::independent_columns;
  return scene;
}

SolverOptions with_independent_columns(SolverOptions options) {
  options.independent_columns = true;
  options.beam_crosses_columns = false;
  ask_for_fluxes_alone(options);
  return options;
}

CostEstimate estimate_cost(const std::vector<Scene>& scenes, std::uint64_t available, int threads, bool compare,
                           CloudFiles& files, int ranks) {
  CostEstimate cost;
  std::vector<std::vector<double>> levels;
  std::size_t kept = 0;
  for (const Scene& given : scenes) {
    const Scene scene = as_solved(given);
    PlannedScene planned = plan_scene(scene, available, files, {}, threads);
    const SolvePlan& plan = planned.plan;
    cost.memory = std::max(cost.memory, predicted_bytes(scene, *planned.scene, plan, ranks));
    double seconds = predict_seconds(plan);
    if (scene.output.error_estimate) {
      const SolvePlan coarse = planned.coarse();
      // Of g-points two have an estimate.
      seconds += predict_coarse_seconds(plan, coarse, planned.as) *
                 (scene.broadband ? std::min(1., estimated_points / static_cast<double>(scenes.size())) : 1.);
      cost.memory = std::max(
          cost.memory, predicted_bytes(scene, *planned.scene, coarse, ranks) + solution_bytes(scene, *planned.scene));
    }
    if (compare) {
      const SolvePlan columns = plan.with(with_independent_columns(plan.whole_options()));
      cost.memory = std::max(cost.memory, predict_memory(columns));
      seconds += predict_seconds(columns);
      kept += solution_bytes(scene, *planned.scene);  // at most: of these, fluxes alone are kept
    }
    cost.solve_seconds.push_back(seconds);
    cost.seconds += seconds;
    levels.push_back(plan.whole().grid.box.z_edge_m);
    kept += solution_bytes(scene, *planned.scene);
    if (scenes.size() == 1) cost.only = std::move(planned);
  }
  if (scenes.front().broadband) {
    // A sum and one solution are kept; of few g-points about so many are solved.
    constexpr double few = 7;
    const auto points = static_cast<double>(scenes.size());
    kept = static_cast<std::size_t>(2 * static_cast<double>(kept) / points);
    constexpr double seconds_of_choice = .02;  // of each g-point, for columns
    if (scenes.front().broadband->method == SceneBroadband::Method::few)
      cost.seconds = cost.seconds * std::min(1., few / points) + seconds_of_choice * points;
  }
  // Reading and writing, measured on scenes of configs/.
  constexpr double seconds_to_start = .03, seconds_of_scene = .01, seconds_of_byte = 1e-8;
  cost.seconds += seconds_to_start + seconds_of_scene * static_cast<double>(scenes.size()) +
                  seconds_of_byte * static_cast<double>(kept);
  if (scenes.size() > 1 || compare) cost.memory += kept;
  cost.seconds *= machine_slowness();
  if (scenes.size() > 1) {
    cost.levels_m = finest_levels(levels);
    if (scenes.front().output.radiance_field) check_same_cells(scenes, available, files, cost.levels_m);
  }
  return cost;
}

std::size_t predicted_memory(const std::vector<Scene>& scenes, std::uint64_t available, int threads) {
  CloudFiles files(scenes.size() > 1);
  return estimate_cost(scenes, available, threads, false, files).memory;
}

}  // namespace cloudbow
