// Some columns of a problem, to tell how well its directions and its cells do: a column by itself has an exact
// solution.
#pragma once

#include "cloudbow/transport/solve_plan.hpp"

namespace cloudbow {

constexpr std::size_t most_probe_columns = 8;

/// Up to that many columns side by side, on the levels as they are solved (SolvePlan), over Lambertian ground of
/// the same albedo: the medians of as many classes of the same number of columns, ordered by optical depth. To be
/// solved each for itself twice: by ordinates, as the iteration knows light, and without azimuths (columns.hpp), which
/// is exact in the vertical and has its eyes near the horizon too.
Problem probe_columns(const SolvePlan& plan);

}  // namespace cloudbow
