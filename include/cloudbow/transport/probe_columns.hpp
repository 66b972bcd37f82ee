// Some columns of a problem, to measure the errors of its directions and cells: an independent column has an exact
// solution.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "cloudbow/transport/solve_plan.hpp"

namespace cloudbow {

/// Up to `count` columns that stand for all: the medians of as many classes of the same number of columns, ordered by
/// optical depth. Columns of equal optical depth are spread evenly over the field.
std::vector<std::size_t> representative_columns(const OpticalGrid& grid, std::size_t count);

/// These columns of a problem as one periodic row, in the order listed, over Lambertian ground of that albedo.
/// @param columns indices j*nx + i, each once.
Problem side_by_side(const Problem& problem, std::span<const std::size_t> columns);

constexpr std::size_t most_probe_columns = 8;

/// Up to that many representative columns side by side, on the levels of the solve (SolvePlan). Each is to be solved
/// independently twice: by ordinates, as in the iteration, and without azimuths (columns.hpp). The second is exact in
/// the vertical and resolves directions near the horizon too.
Problem probe_columns(const SolvePlan& plan);

}  // namespace cloudbow
