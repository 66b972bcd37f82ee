// Cells so thick that their light is no longer known by its mean and slope.
#pragma once

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Light that thick absorbing cells should send back and do not, fraction of incident, mean over the columns. A cell
/// spreads over its whole height what light scatters near its face, so that less of it gets out again: over k = sqrt(3
/// (1 - ssa) (1 - ssa g)) times the optical depth the share that is left falls as 1 / (1 + .12 x^2 / (1 + .3 x)),
/// fitted to slabs of four cells against doubling (docs/extremes.md). What a cell would send back: the albedo of a half
/// space (van de Hulst, Multiple Light Scattering, 1980). 0 below x = .5, where the distance between companions tells,
/// and where columns are solved without azimuths, which know light at every depth.
double light_lost_in_thick_cells(const Problem& problem, const SolverOptions& options);

/// Beyond an optical depth of 1e6 a cell's own light is lost in rounding, and the iteration with it.
/// @throws InputError where a cell that scatters is thicker.
void check_cell_thickness(const Problem& problem);

}  // namespace cloudbow
