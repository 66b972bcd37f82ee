// Layers of air at a scene's g-point.
#pragma once

#include "cloudbow/app/scene.hpp"
#include "cloudbow/medium/cloud_field.hpp"

namespace cloudbow {

/// Adds the gases of the scene's atmosphere as layers, from the bottom of the domain to its top: absorption, and
/// scattering by molecules. Without domain.min_m and max_m these are 0 m (or the bottom of the cloud's box, if that is
/// lower) and the end of the atmosphere. Levels are the same at all g-points.
/// @param field the scene's cloud, or null. @throws InputError if the atmosphere lacks gases of the model.
void add_gas_layers(const CloudField* field, Scene& scene);

}  // namespace cloudbow
