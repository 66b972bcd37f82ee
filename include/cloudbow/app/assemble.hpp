// From a scene to what the solver takes: opens the cloud, joins it with the layers, fills in the ladder.
#pragma once

#include <cstdint>

#include "cloudbow/app/scene.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

struct AssembledScene {
  Problem problem;
  SolverOptions options;
};

/// @param memory_limit_bytes of the optical grid; told before it is taken.
/// @throws InputError where the cloud cannot be read or does not fit the scene (domain off the voxel faces or too
/// small, quantity or effective radius missing).
AssembledScene assemble(const Scene& scene, std::uint64_t memory_limit_bytes);

/// Direction in which sunlight travels, from where the sun stands.
Direction sun_travel(const SceneSun& sun);

}  // namespace cloudbow
