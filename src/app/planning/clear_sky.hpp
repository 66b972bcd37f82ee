// The same scene without its clouds.
#pragma once

#include <cstdint>
#include <vector>

#include "app/planning/run_options.hpp"
#include "cloudbow/app/scene.hpp"
#include "cloudbow/medium/cloud_files.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// @throws InputError if nothing is left without the cloud, or the ground has a map, which needs the cloud's columns.
void check_clear_sky(const Scene& scene);

/// Solves the scenes without their clouds, as a run of the scene without [cloud] does: one solution for each, or the
/// sum over the g-points of a gas model. Fluxes alone, at all levels. @throws Interrupted.
std::vector<Solution> solve_clear_sky(const std::vector<Scene>& scenes, const RunOptions& options,
                                      std::uint64_t available, CloudFiles& files);

}  // namespace cloudbow
