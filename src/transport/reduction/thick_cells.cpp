#include "cloudbow/transport/thick_cells.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

constexpr double largest_optical_depth = 1e6;

}  // namespace

void check_cell_thickness(const Problem& problem) {
  const OpticalGrid& grid = problem.grid;
  double largest = 0;
  grid.for_each_cell([&](int k, std::size_t c, std::uint32_t) {
    const bool scatters = std::any_of(grid.scattering.begin(), grid.scattering.end(),
                                      [c](const auto& of_phase) { return of_phase[c] > 0; });
    if (scatters) largest = std::max(largest, grid.box.thickness_m(k) * grid.extinction(c));
  });
  if (largest > largest_optical_depth) {
    throw InputError(
        fmt::format("cell: too thick to be solved (found an optical depth of {:.4g}, allowed up to {:g} if light "
                    "scatters); thinner cells, or solver.mode = \"independent-columns\", which takes any",
                    largest, largest_optical_depth));
  }
}

}  // namespace cloudbow
