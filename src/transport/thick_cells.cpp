#include "cloudbow/transport/thick_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cloudbow/core/error.hpp"
#include "cloudbow/transport/columns.hpp"
#include "cloudbow/transport/thick_levels.hpp"

namespace cloudbow {
namespace {

constexpr double kLargestOpticalDepth = 1e6;
constexpr double kResolved = .5;
constexpr double kNeighbour = .1;  // of a cell's scattering: less beside it is as good as nothing

/// Of one cell.
struct Thickness {
  double absorption = 0;  ///< optical depths, from bottom to top
  double scattering = 0;
  double transport = 0;  ///< of scattering: times 1 - g

  double diffusion() const { return std::sqrt(3 * absorption * (absorption + transport)); }
  /// Without a neighbour above or below a cell has no slope: about half of what it scatters goes on downwards, however
  /// thick it is.
  double lost_alone() const {
    const double ratio = .49 * transport * transport / (transport + .78);
    return .5 * ratio / (1 + ratio);
  }
  double lost_in_depth() const {
    const double x = diffusion();
    if (x < kResolved || scattering <= 0) return 0;
    const double s = std::sqrt(absorption / (absorption + transport));
    const double half_space = (1 - s) * (1 - .139 * s) / (1 + 1.17 * s);
    const double excess = .12 * x * x / (1 + .3 * x);
    return half_space * excess / (1 + excess);
  }
};

/// Calls see(column, k, thickness) for all active cells, from the top down.
template <class See>
void look_down(const Problem& problem, See see) {
  const OpticalGrid& grid = problem.grid;
  const BoxGrid& box = grid.box;
  for (int k = box.nz() - 1; k >= 0; --k) {
    const double height = box.thickness_m(k);
    for (int j = 0; j < box.ny; ++j) {
      const std::size_t row = static_cast<std::size_t>(k) * box.ny + j;
      for (std::uint32_t s = grid.row_begin[row]; s < grid.row_begin[row + 1]; ++s) {
        const RowSpan& span = grid.spans[s];
        for (int n = 0; n < span.n; ++n) {
          const std::size_t c = span.offset + static_cast<std::size_t>(n);
          Thickness thickness{height * static_cast<double>(grid.absorption[c])};
          for (std::size_t p = 0; p < grid.scattering.size(); ++p) {
            const double scattering = height * static_cast<double>(grid.scattering[p][c]);
            thickness.scattering += scattering;
            thickness.transport += scattering * (1 - problem.phase[p].asymmetry_parameter());
          }
          see(static_cast<std::size_t>(j) * box.nx + span.i + n, k, thickness);
        }
      }
    }
  }
}

}  // namespace

double light_lost_in_thick_cells(const Problem& problem, const SolverOptions& options) {
  if (solved_without_azimuths(problem, options)) return 0;
  // Of cells as they are solved.
  if (const CutLevels cut = cut_thick_levels(problem, options); cut.added(problem.grid.box) > 0)
    return light_lost_in_thick_cells(with_cut_levels(problem, cut), with_cut_levels(options, cut));
  /// Of a column so far, and of its last cell, which has not been counted.
  struct Above {
    double diffusion = 0, transport = 0, lost = 0;
    int k = -2;
    Thickness last;
    bool alone = false;

    void count(const Thickness& below) {
      // There and back through what lies above.
      const double seen = std::exp(-diffusion) / (1 + .75 * transport);
      const bool lone = alone && below.scattering < kNeighbour * last.scattering;
      lost = std::max(lost, std::max(last.lost_in_depth(), lone ? last.lost_alone() : 0) * seen * seen);
      diffusion += last.diffusion();
      transport += last.transport;
    }
  };
  std::vector<Above> columns(problem.grid.box.columns());
  look_down(problem, [&](std::size_t column, int k, const Thickness& thickness) {
    Above& above = columns[column];
    const bool touches = above.k == k + 1;
    if (above.k >= 0) above.count(touches ? thickness : Thickness{});
    above.alone = !touches || above.last.scattering < kNeighbour * thickness.scattering;
    above.last = thickness;
    above.k = k;
  });
  double sum = 0;
  for (Above& above : columns) {
    if (above.k >= 0) above.count(Thickness{});
    sum += above.lost;
  }
  return sum / static_cast<double>(columns.size());
}

void check_cell_thickness(const Problem& problem) {
  double largest = 0;
  look_down(problem, [&](std::size_t, int, const Thickness& thickness) {
    if (thickness.scattering > 0) largest = std::max(largest, thickness.absorption + thickness.scattering);
  });
  if (largest > kLargestOpticalDepth) {
    throw InputError(
        fmt::format("cell: too thick to be solved (found an optical depth of {:.4g}, allowed up to {:g} where light "
                    "scatters) thinner cells, or solver.mode = \"independent-columns\", which takes any",
                    largest, kLargestOpticalDepth));
  }
}

}  // namespace cloudbow
