#include "app/planning/clear_sky.hpp"

#include <fmt/format.h>

#include <utility>

#include "app/planning/cost_estimate.hpp"
#include "app/process/interrupt.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/results/weighted_sum.hpp"
#include "cloudbow/transport/output_fields.hpp"
#include "cloudbow/transport/solver.hpp"

namespace cloudbow {
namespace {

Scene without_cloud(Scene scene) {
  scene.clouds.clear();
  // Its horizontal extent and the height of its voxel faces have no meaning without voxels.
  scene.radiances.clear();
  scene.cameras.clear();
  scene.output.heights_m.clear();
  scene.output.flux_levels = FluxLevels::all;
  ask_for_fluxes_alone(scene.output);
  scene.output.heating_rate = scene.output.optical_depth = scene.output.extinction = false;
  scene.solver.mode = SolveMode::automatic;
  return scene;
}

}  // namespace

void check_clear_sky(const Scene& scene) {
  const char* const found = scene.clouds.empty()                       ? "no [cloud]"
                            : scene.layers.empty() && !scene.broadband ? "a cloud alone"
                            : !scene.albedo_map.empty()                ? "surface.albedo_map"
                            : !scene.temperature_map.empty()           ? "surface.temperature_map"
                                                                       : nullptr;
  if (found == nullptr) return;
  throw InputError(fmt::format(
      "{}: --clear-sky: there is no such sky (found {}, allowed a cloud with [[layer]] or spectrum.gas_model, no maps)",
      scene.path.string(), found));
}

std::vector<Solution> solve_clear_sky(const std::vector<Scene>& scenes, const RunOptions& options,
                                      std::uint64_t available, CloudFiles& files) {
  std::vector<Scene> clear;
  for (const Scene& scene : scenes) clear.push_back(without_cloud(scene));
  const CostEstimate cost = estimate_cost(clear, available, options.threads, false, files);
  std::vector<Solution> solutions;
  for (const Scene& scene : clear) {
    const PlannedScene planned = plan_scene(scene, available, files, cost.levels_m, options.threads);
    Solution solution = solve(planned.plan, [](const SolverProgress&) { InterruptGuard::check(); });
    if (scene.broadband && !solutions.empty()) {
      add_weighted(solutions.front(), solution, 1);
    } else {
      solutions.push_back(std::move(solution));
    }
  }
  return solutions;
}

}  // namespace cloudbow
