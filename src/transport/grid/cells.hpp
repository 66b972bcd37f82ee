// The active cells as the kernels see them: delta-M scaled coefficients in contiguous arrays, rows that hold any, and
// each cell's neighbours.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "cloudbow/medium/optical_grid.hpp"
#include "transport/grid/lanes.hpp"

namespace cloudbow {

/// Up to `lanes` neighbouring cells of one row, which a kernel crosses at a time.
struct Chunk {
  std::uint32_t cell;   ///< index of the first
  std::int32_t column;  ///< of the first
  std::int32_t row;
  std::int32_t n;
};

/// Cells as a march along one axis meets them: sheet after sheet across that axis, row after row.
struct Sheets {
  int count = 0;
  int rows = 0;
  int columns = 0;
  std::vector<std::uint32_t> begin;  ///< [count][rows + 1] first chunk of each row, and the end of the sheet's
  std::vector<Chunk> chunks;         ///< with `padding` more behind them, for marches that look ahead
  static constexpr int padding = 8;

  std::span<const Chunk> of(int sheet) const { return of(sheet, 0, rows); }
  std::span<const Chunk> of(int sheet, int first_row, int last_row) const {
    const std::uint32_t* const row = begin.data() + static_cast<std::size_t>(sheet) * (rows + 1);
    return {chunks.data() + row[first_row], chunks.data() + row[last_row]};
  }
};

/// Levels [first, last).
struct LevelRange {
  int first;
  int last;
};

/// Whether two levels have one thickness. Heights that were read from a file have rounding errors.
inline bool have_one_thickness(const BoxGrid& box, int k, int other) {
  return std::abs(box.thickness_m(other) - box.thickness_m(k)) <= 1e-6 * box.thickness_m(k);
}

/// Whether ordinates may be marched along x and y, through runs of levels of one thickness.
inline bool may_march_sideways(const BoxGrid& box, bool independent_columns) {
  return box.periodic && box.nx > 1 && box.ny > 1 && !independent_columns;
}

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
  Sheets levels;                          ///< along z
  /// [nz] blocks of air of each level, which are its last cells; empty: none has any.
  std::vector<AirBlocks> air;
  Sheets gaps;  ///< along z: all places of a chunk, of any number, have the chunk's one cell
  /// The same, block by block of each level. A level without voxels and with one block is one chunk of all its columns.
  std::vector<Chunk> gaps_by_block;
  std::vector<std::uint32_t> first_gap;  ///< [nz + 1] chunks of level k are [first_gap[k], first_gap[k+1])
  std::vector<std::uint32_t> places;     ///< [n] voxels that have this cell; empty: one each

  std::size_t size() const { return level_cell.back(); }
  std::size_t largest_level() const;
  double places_of(std::size_t cell) const { return places.empty() ? 1 : places[cell]; }
  bool has_air() const { return !air.empty(); }
  /// Cells of single voxels in level k are [level_cell[k], voxels_end(k)).
  std::uint32_t voxels_end(int k) const {
    return air.empty() ? level_cell[k + 1] : level_cell[k + 1] - static_cast<std::uint32_t>(air[k].count());
  }
  bool has_voxels(int k) const { return level_cell[k] < voxels_end(k); }
  /// Whether all voxels of level k share one cell, or none has any. Horizontally nothing varies in it then.
  bool is_uniform(int k) const {
    return !has_voxels(k) &&
           (level_cell[k] == level_cell[k + 1] ||
            (level_cell[k] + 1 == level_cell[k + 1] &&
             places[level_cell[k]] == static_cast<std::uint32_t>(nx) * static_cast<std::uint32_t>(ny)));
  }
  /// Whether level k has voxels of clouds, and one block of air that most of its voxels share.
  bool is_mostly_air(int k) const {
    if (air.empty() || air[k].count() != 1 || !has_voxels(k)) return false;
    return 2 * static_cast<std::size_t>(places[air[k].first_cell]) >=
           static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny);
  }
  std::span<const Chunk> blocks_of(int k) const {
    if (air.empty()) return {};
    return {gaps_by_block.data() + first_gap[k], gaps_by_block.data() + first_gap[k + 1]};
  }
};

ActiveRows active_rows(const OpticalGrid& grid);

/// Calls use(cell, place) for every voxel that has a cell, place = (k*ny + j)*nx + i, level by level.
template <class Use>
void for_each_place(const ActiveRows& rows, const Use& use) {
  for (int k = 0; k < rows.nz; ++k) {
    const auto place = [&](const Chunk& chunk) {
      return (static_cast<std::size_t>(k) * rows.ny + chunk.row) * rows.nx + chunk.column;
    };
    for (const Chunk& chunk : rows.levels.of(k)) {
      for (int i = 0; i < chunk.n; ++i) use(chunk.cell + static_cast<std::uint32_t>(i), place(chunk) + i);
    }
    if (!rows.has_air()) continue;
    for (const Chunk& chunk : rows.gaps.of(k)) {
      for (int i = 0; i < chunk.n; ++i) use(chunk.cell, place(chunk) + i);
    }
  }
}

/// The cells as a march along x or y meets them: sheets along that axis, rows by level, columns along the other.
template <class Real>
struct TransposedCells {
  Sheets sheets;
  Sheets gaps;
  /// Along x, for which cells have a separate order: [n] index of each among the cells, and [n + lane_padding] their
  /// extinction.
  std::vector<std::uint32_t> cell;
  std::vector<Real> extinction;
};

template <class Real>
struct CellView;

/// Thermal emission as a part of the source of cells; null: none.
template <class Real>
struct CellEmission {
  const Real* source = nullptr;  ///< [n] as Cells::emitted
  const Real* step = nullptr;    ///< [n] as Cells::emitted_step
};

/// Cells of one problem in the precision Real, forward peaks truncated.
template <class Real>
struct Cells {
  ActiveRows rows;
  /// True for many cells that change along each horizontal axis with more than one cell. The sweep uses its shortcuts
  /// for such fields only (march along x and y, one gradient for an octant). In a field without change along an axis
  /// the shortcuts would appear as such a change.
  bool heterogeneous = false;
  /// Runs of two or more levels of one thickness, from below, and their cells for marches along x and y. Empty: all
  /// marches are along z.
  std::vector<LevelRange> even_runs;
  std::array<TransposedCells<Real>, 2> transposed;
  std::vector<Real> extinction;  ///< [n + lane_padding] sigma' = absorption + sum_p (1 - f_p) scattering_p, 1/m
  /// [n] 1 / places of each cell of the air, that of a voxel's cell is 1; empty: no cell is of the air.
  std::vector<Real> share_of_place;
  std::vector<std::vector<Real>>
      scattered;  ///< [p][n] (1 - f_p) scattering_p / sigma': share of the extinction scattered by p
  /// [n] thermal emission absorption B / sigma', the same in all directions, W m-2 sr-1; empty: nothing emits.
  std::vector<Real> emitted;
  std::vector<Real> emitted_step;  ///< [n] of B, at the cell's top less at its bottom, relative to B
  /// Central differences of the source along x, y, z: slope = scale * (source[high] - source[low]) per cell. A cell of
  /// hardly any matter (1e-4 of the cell's own extinction) is no neighbour. If the neighbour above or below is missing,
  /// the cell itself replaces it and the difference is one-sided. If a horizontal neighbour is missing, the slope is
  /// zero.
  std::array<std::vector<std::uint32_t>, 3> low;
  std::array<std::vector<std::uint32_t>, 3> high;
  std::array<std::vector<Real>, 3> scale;

  std::size_t size() const { return rows.size(); }
  /// Whether light comes from any cell of level k: one that scatters or emits.
  bool sends_light(int k) const {
    const auto in_level = [&](const std::vector<Real>& of) {
      return !of.empty() && std::any_of(of.begin() + rows.level_cell[k], of.begin() + rows.level_cell[k + 1],
                                        [](Real share) { return share > 0; });
    };
    return in_level(emitted) || std::any_of(scattered.begin(), scattered.end(), in_level);
  }
  CellEmission<Real> emission() const {
    return emitted.empty() ? CellEmission<Real>{} : CellEmission<Real>{emitted.data(), emitted_step.data()};
  }
  /// @param extinction_of, x, y, z in the order of a march: extinction and gradient along its axes.
  CellView<Real> view(const std::vector<Real>& extinction_of, const std::vector<Real>& x, const std::vector<Real>& y,
                      const std::vector<Real>& z) const;
};

/// Horizontal axes of more than one cell along which cells differ.
struct VaryingAxes {
  bool x = false;
  bool y = false;
  bool any() const { return x || y; }
};
template <class Real>
VaryingAxes varying_axes(const Cells<Real>& cells);

/// Data of the cells that a march reads, in the order of its axes: the pattern's x and y, and the axis of the march.
template <class Real>
struct CellView {
  const Real* extinction;
  std::array<const Real*, 3> gradient{};  ///< relative, of the source; null: it is constant in each cell
  const Real* share_of_place = nullptr;   ///< as that of Cells

  CellView(const Real* extinction_of, const std::array<const Real*, 3>& gradient_of)
      : extinction(extinction_of), gradient(gradient_of) {}
  /// @param x, y, z gradient along the march's axes, [n + lane_padding]; empty: the source is constant.
  CellView(const Real* extinction_of, const std::vector<Real>& x, const std::vector<Real>& y,
           const std::vector<Real>& z)
      : extinction(extinction_of) {
    if (!x.empty()) gradient = {x.data(), y.data(), z.data()};
  }

  bool is_linear() const { return gradient[0] != nullptr; }
};

template <class Real>
CellView<Real> Cells<Real>::view(const std::vector<Real>& extinction_of, const std::vector<Real>& x,
                                 const std::vector<Real>& y, const std::vector<Real>& z) const {
  CellView<Real> cells(extinction_of.data(), x, y, z);
  cells.share_of_place = share_of_place.data();
  return cells;
}

/// @param forward_fraction [p] f of each phase function.
/// @param independent_columns no differences along x and y (independent columns).
/// @param worth_shortcuts fewer cells than this are never `varied`: they are solved soon enough without.
template <class Real>
Cells<Real> make_cells(const OpticalGrid& grid, std::span<const double> forward_fraction, bool independent_columns,
                       std::size_t worth_shortcuts = 2000);

/// Indices (k*ny + j)*nx + i of the active cells; those of the air have no_place.
constexpr std::uint32_t no_place = 0xFFFFFFFF;
std::vector<std::uint32_t> dense_indices(const ActiveRows& rows);
std::vector<std::uint32_t> dense_indices(const OpticalGrid& grid);

}  // namespace cloudbow
