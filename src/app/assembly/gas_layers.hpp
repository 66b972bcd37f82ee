// Layers of air at a scene's g-point.
#pragma once

#include "cloudbow/app/scene.hpp"
#include "cloudbow/medium/cloud_field.hpp"

namespace cloudbow {

/// Adds the gases of the scene's atmosphere as layers: absorption, and scattering by molecules. They fill the domain.
/// Without domain.min_m it begins at 0 m, or at the bottom of the cloud's box if that is lower. Without domain.max_m it
/// ends with the atmosphere, or the box if that is higher. Levels are the same at all g-points.
/// @param field the scene's cloud, or null. @throws InputError if the atmosphere lacks gases of the model.
void add_gas_layers(const CloudField* field, Scene& scene);

}  // namespace cloudbow
