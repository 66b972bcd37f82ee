// Cells so thick that their light is no longer known by its mean and slope.
#pragma once

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Light that thick cells should send back and do not, fraction of incident, mean over the columns.
/// An absorbing cell spreads over its whole height what light scatters near its face, so that less of it gets out
/// again: over x = sqrt(3 (1 - ssa) (1 - ssa g)) times the optical depth the share that is left falls as 1 / (1 + .12
/// x^2 / (1 + .3 x)). What it would send back: the albedo of a half space (van de Hulst, Multiple Light Scattering,
/// 1980). Counted from x = .5 on; below, the distance between companions tells.
/// A cell without a neighbour above and below has no slope, absorbing or not: of its transport optical depth t it lacks
/// y / (1 + y) / 2, y = .49 t^2 / (t + .78).
/// Both fitted to slabs against doubling (docs/extremes.md). 0 where columns are solved without azimuths, which know
/// light at every depth.
double light_lost_in_thick_cells(const Problem& problem, const SolverOptions& options);

/// Beyond an optical depth of 1e6 a cell's own light is lost in rounding, and the iteration with it.
/// @throws InputError where a cell that scatters is thicker.
void check_cell_thickness(const Problem& problem);

}  // namespace cloudbow
