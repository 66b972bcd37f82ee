// Counts of the work of a solve, from which its memory and time are predicted.
#pragma once

#include <cstddef>
#include <vector>

#include "cloudbow/transport/solve_plan.hpp"

namespace cloudbow {

/// Threads of the solve.
int threads_of(const SolvePlan& plan);

/// The same views in smaller images, which have the same contents. @param enough pixels along an axis
std::vector<Camera> coarser(std::vector<Camera> cameras, int enough);

/// Number of directions towards which the source is computed for images.
std::size_t directions_seen(const SolverOptions& options, std::size_t cells);

/// Flux levels between bottom and top.
std::vector<int> inner_levels(const BoxGrid& box, const SolverOptions& options);

/// Work in one level.
struct LevelWork {
  double thickness_m = 0;
  double runs = 0;         ///< of up to eight neighbouring cells in a row, which are computed together
  double runs_of_air = 0;  ///< of up to eight rays that cross blocks of air between them, as runs of cells
  bool even = false;       ///< a level next to it has its thickness: it can be marched along x and y
  bool in_air = false;     ///< a march along z crosses all of the air at once
};

/// Figures of the cells as the iteration sees them, with truncated forward peaks.
struct Medium {
  double cells = 0;
  std::vector<LevelWork> levels;
  double voxel_depth = 0;      ///< vertical optical depth of a voxel, mean with the extinction as weight
  double coarse_depth = 0;     ///< the same for transport scattering, of the widest edge of a cell twice as large
  double transport_depth = 0;  ///< of the columns for transport scattering, each weighted with its own

  double runs() const;
};

Medium medium_of(const SolvePlan& plan);

/// Whether the low-order correction has coarse cells, of which there are about a sixth.
bool coarsens(const SolvePlan& plan, const Medium& medium);
inline constexpr double coarse_cells_per_cell = 1. / 6;

/// Cells of the level that has the most.
std::size_t cells_of_largest_level(const OpticalGrid& grid);

}  // namespace cloudbow
