// The matter of one grid in other cells: without an axis, with levels in parts, some columns side by side.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "cloudbow/medium/optical_grid.hpp"

namespace cloudbow {

/// Cells of a new grid, each with the cell of another grid whose coefficients it has. Filled row by row, in the order
/// of the cells (k, j, i).
struct GridMap {
  /// A cell without matter.
  static constexpr std::uint32_t no_cell = std::numeric_limits<std::uint32_t>::max();

  BoxGrid box;
  std::vector<int> level;                      ///< [nz] level of the other grid whose layers each level has
  std::vector<std::uint32_t> row_begin = {0};  ///< as OpticalGrid's
  std::vector<RowSpan> spans;
  std::vector<std::uint32_t> cell;  ///< [n] cell of the other grid, or no_cell
  std::vector<AirBlocks> air;       ///< [nz], or empty

  /// Adds cell i of the row.
  void add(std::int32_t i, std::uint32_t from);
  void end_row() { row_begin.push_back(static_cast<std::uint32_t>(spans.size())); }
  /// After the last row of a level: `shape`, each of its blocks from that of `from` at the same place.
  void add_air(const AirBlocks& from, AirBlocks shape);
  void add_air(const AirBlocks& from) { add_air(from, from); }
};

/// The levels of `grid` as they are: what GridMap::level is if levels do not change.
std::vector<int> same_levels(const OpticalGrid& grid);

/// The grid whose cells have the coefficients of `grid` at map.cell. Its levels have the layers of `grid` at map.level.
OpticalGrid remap(const OpticalGrid& grid, GridMap map);

/// Every cell of the box active: for light in cells without matter too. No blocks of air are left.
OpticalGrid with_empty_cells(const OpticalGrid& grid);

/// Layers in the voxels' own cells, in place of blocks, in the levels below level `end`.
OpticalGrid without_air_blocks(const OpticalGrid& grid, int end = std::numeric_limits<int>::max());

}  // namespace cloudbow
