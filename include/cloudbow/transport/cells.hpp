// The active cells as the kernels see them: delta-M scaled coefficients in contiguous arrays, rows that hold any, and
// each cell's neighbours.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "cloudbow/medium/optical_grid.hpp"

namespace cloudbow {

/// Floats that a kernel crosses at a time, and what it may read behind the end of its arrays.
inline constexpr int lanes = 8;
inline constexpr std::size_t lane_padding = 8;

/// A row of a level that holds active cells: spans [first, last).
struct ActiveRow {
  std::int32_t j;
  std::uint32_t first_span;
  std::uint32_t last_span;
};

struct ActiveRows {
  int nx = 1;
  int ny = 1;
  int nz = 1;
  std::vector<std::uint32_t> level_row;  ///< [nz + 1] rows of level k are rows[level_row[k] .. level_row[k+1])
  std::vector<ActiveRow> rows;
  std::vector<RowSpan> spans;
  std::vector<std::uint32_t> level_cell;  ///< [nz + 1] cells of level k are [level_cell[k], level_cell[k+1])

  std::size_t size() const { return level_cell.back(); }
  std::size_t largest_level() const;
};

ActiveRows active_rows(const OpticalGrid& grid);

/// Cells of one problem in the precision Real, forward peaks truncated.
template <class Real>
struct Cells {
  ActiveRows rows;
  std::vector<Real> extinction;  ///< [n + lane_padding] sigma' = absorption + sum_p (1 - f_p) scattering_p, 1/m
  std::vector<std::vector<Real>>
      scattered;  ///< [p][n] (1 - f_p) scattering_p / sigma': what of the light taken out scatters by p
  /// Central differences of the source along x, y, z: slope = scale * (source[high] - source[low]) per cell. Where a
  /// neighbour is missing above or below, the cell itself stands in and the difference is one-sided; beside, the slope
  /// is zero.
  std::array<std::vector<std::uint32_t>, 3> low;
  std::array<std::vector<std::uint32_t>, 3> high;
  std::array<std::vector<Real>, 3> scale;

  std::size_t size() const { return rows.size(); }
};

/// @param forward_fraction [p] f of each phase function.
/// @param vertical no differences along x and y (independent columns).
template <class Real>
Cells<Real> make_cells(const OpticalGrid& grid, std::span<const double> forward_fraction, bool vertical);

/// Indices (k*ny + j)*nx + i of the active cells.
std::vector<std::uint32_t> dense_indices(const ActiveRows& rows);

}  // namespace cloudbow
