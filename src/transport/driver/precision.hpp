// Choice between float and double.
#pragma once

#include "cloudbow/medium/optical_grid.hpp"
#include "cloudbow/transport/options.hpp"

namespace cloudbow {

/// Whether float cannot distinguish radiance from source in these cells, so that the iteration converges in double
/// alone.
bool too_thick_for_float(const OpticalGrid& grid);

/// Whether the tolerance is below what float resolves in this medium, and double is affordable. Otherwise the iteration
/// stalls. float16 storage is a choice of less memory, and stays.
/// @param cells for which light is computed
bool tolerance_needs_double(const OpticalGrid& grid, std::size_t cells, const SolverOptions& options);

}  // namespace cloudbow
