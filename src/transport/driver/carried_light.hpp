// Light of one solve in the cells of another, which subdivides levels and columns in another way.
#pragma once

#include "cloudbow/transport/cell_light.hpp"

namespace cloudbow {

/// Whether both solves have the same cells before these are subdivided.
bool can_carry(const CellLight& light, const SolvePlan& plan);

/// The light in the cells of the plan's problem: its mean over the parts of each cell that is not subdivided. Slopes
/// within parts become those of the same gradient.
/// @param light that can be carried there, with the cells of its plan's problem.
CellLight carried_light(CellLight&& light, const SolvePlan& plan);

}  // namespace cloudbow
