// Some columns of a problem, to measure the errors of its directions and cells: an independent column has an exact
// solution.
#pragma once

#include "cloudbow/transport/solve_plan.hpp"

namespace cloudbow {

constexpr std::size_t most_probe_columns = 8;

/// Up to that many columns side by side, on the levels of the solve (SolvePlan), over Lambertian ground of that albedo.
/// They are the medians of as many classes of the same number of columns, ordered by optical depth. Each is to be
/// solved independently twice: by ordinates, as in the iteration, and without azimuths (columns.hpp). The second is
/// exact in the vertical and resolves directions near the horizon too.
Problem probe_columns(const SolvePlan& plan);

}  // namespace cloudbow
