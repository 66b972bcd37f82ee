// Columns of thick voxels are subdivided: there light enters through the sides and fades within the first metres.
#pragma once

#include "cloudbow/transport/reductions.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Columns get equal parts along each axis, options.max_column_parts at most. The optical depth of a part, from side to
/// side, is then options.max_column_optical_depth or less if these suffice. That depth is delta-M scaled; mean over the
/// cells by the power that the beam loses there. Across the sun's azimuth, along which less light enters through sides,
/// a part may have twice that depth. Columns stay whole if that option is 0, for independent columns, and without sun.
SubdividedColumns subdivide_thick_columns(const Problem& problem, const SolverOptions& options);

/// The same problem with cells for each part.
Problem with_subdivided_columns(const Problem& problem, SubdividedColumns parts);

/// The solution of a problem with subdivided columns becomes that of the whole: means over its columns and cells.
void join_columns(const Problem& whole, SubdividedColumns parts, Solution& solution);

}  // namespace cloudbow
