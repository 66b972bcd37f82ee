#include "cloudbow/transport/thick_cells.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

constexpr double kLargestOpticalDepth = 1e6;

}  // namespace

void check_cell_thickness(const Problem& problem) {
  const OpticalGrid& grid = problem.grid;
  const std::size_t ny = static_cast<std::size_t>(grid.box.ny);
  double largest = 0;
  for (std::size_t row = 0; row + 1 < grid.row_begin.size(); ++row) {
    const double height = grid.box.thickness_m(static_cast<int>(row / ny));
    for (std::uint32_t s = grid.row_begin[row]; s < grid.row_begin[row + 1]; ++s) {
      const RowSpan& span = grid.spans[s];
      for (std::size_t c = span.offset; c < span.offset + static_cast<std::size_t>(span.n); ++c) {
        double scattering = 0;
        for (const auto& of_phase : grid.scattering) scattering += static_cast<double>(of_phase[c]);
        if (scattering > 0)
          largest = std::max(largest, height * (static_cast<double>(grid.absorption[c]) + scattering));
      }
    }
  }
  if (largest > kLargestOpticalDepth) {
    throw InputError(
        fmt::format("cell: too thick to be solved (found an optical depth of {:.4g}, allowed up to {:g} where light "
                    "scatters) thinner cells, or solver.mode = \"independent-columns\", which takes any",
                    largest, kLargestOpticalDepth));
  }
}

}  // namespace cloudbow
