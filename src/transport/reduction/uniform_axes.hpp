// Fields that do not vary along x or y are solved without that axis: a slab as one column, a field of rolls as a slice.
#pragma once

#include "cloudbow/transport/reductions.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Axes along which cloud, layers and surface are uniform, to the bit. None with open sides, because their light varies
/// in any case.
UniformAxes uniform_axes(const Problem& problem);

/// The same problem with one cell along uniform axes.
Problem collapse(const Problem& problem, UniformAxes uniform);

/// The solution of a problem without axes becomes that of the whole.
void spread(const Problem& whole, UniformAxes uniform, Solution& solution);

}  // namespace cloudbow
