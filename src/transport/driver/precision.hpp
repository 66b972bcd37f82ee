// Choice between float and double.
#pragma once

#include "cloudbow/medium/optical_grid.hpp"

namespace cloudbow {

/// Whether float cannot distinguish radiance from source in these cells, so that the iteration converges in double
/// alone.
bool too_thick_for_float(const OpticalGrid& grid);

}  // namespace cloudbow
