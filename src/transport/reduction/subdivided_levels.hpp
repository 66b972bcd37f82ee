// Levels in which the direct beam fades within a cell are subdivided: there a source that is linear
// in the cell would be too even. So are levels of thick cells that light enters through sides of the cloud. Levels of
// thin cells stay whole.
#pragma once

#include "cloudbow/transport/reductions.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// The first part of a level, from above, has the slant optical depth options.max_level_optical_depth. That depth
/// is delta-M scaled, over mu0; mean over the cells by the power that the beam loses there. Each further part has
/// twice that of the part above it. Six parts at most; they are thicker if these do not suffice. Levels in which
/// less than a hundredth of the incident beam is scattered or absorbed have no such parts. Levels of up to 2.5
/// times the option's depth have two equal parts if their columns differ. Ordinates can then be marched along x and
/// y, which independent columns and open boxes do not need.
///
/// Other levels get equal parts if some of their columns are clear: parts of the vertical optical depth
/// options.max_column_optical_depth, three at most. All levels stay whole if the option max_level_optical_depth is 0,
/// and without sun.
SubdividedLevels subdivide_thick_levels(const Problem& problem, const SolverOptions& options);

/// The same problem with cells for each part.
Problem with_subdivided_levels(const Problem& problem, const SubdividedLevels& cut);
/// Its options: listed levels have other indices.
SolverOptions with_subdivided_levels(const SolverOptions& options, const SubdividedLevels& cut);

/// The solution of a problem with subdivided levels becomes that of the whole: fluxes at its levels, means of its
/// cells.
void join_levels(const Problem& whole, const SubdividedLevels& cut, Solution& solution);

}  // namespace cloudbow
