// Which rays of a direction are in which cells: rows of rays against rows of cells (docs/theory.md, "Shared pattern").
// Rays are identified by their launch columns; in a segment of shift (ox, oy) the ray of column (m, r) is in cell
// (m + ox, r + oy), modulo the box. Rays never move in memory.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "transport/grid/cells.hpp"
#include "transport/rays/path_pattern.hpp"

namespace cloudbow {

inline int wrapped(int i, int n) {
  const int r = i % n;
  return r < 0 ? r + n : r;
}

/// Calls `cross(ray, cell, n)` for rays of the row of nx rays from index `row`: those that lie in the chunk when the
/// row is shifted by `shift` columns. They form one run or, at the seam, two.
template <class Cross>
[[gnu::always_inline]] inline void cross_run(std::size_t row, const Chunk& chunk, int shift, int nx,
                                             const Cross& cross) {
  int m = chunk.column - shift;
  if (m < 0) m += nx;
  const int before_seam = nx - m;
  if (chunk.n <= before_seam) {
    cross(row + m, chunk.cell, chunk.n);
  } else {
    cross(row + m, chunk.cell, before_seam);
    cross(row, chunk.cell + before_seam, chunk.n - before_seam);
  }
}

/// Calls air.cross(ray, n) for rays in a gap. They are of the row of nx rays from index `row`.
template <class Air>
[[gnu::always_inline]] inline void cross_gap(std::size_t row, const Chunk& gap, int shift, int nx, Air& air) {
  int m = gap.column - shift;
  if (m < 0) m += nx;
  const int before_seam = std::min(gap.n, nx - m);
  air.cross(row + m, before_seam);
  if (gap.n > before_seam) air.cross(row, gap.n - before_seam);
}

/// Calls `cross(ray, cell, n)` for the runs of chunks, with rays shifted by (ox, oy) columns modulo the box.
/// @param ox, oy from 0 up to nx - 1 and ny - 1.
template <class Cross>
[[gnu::always_inline]] inline void cross_chunks(std::span<const Chunk> chunks, int ox, int oy, int nx, int ny,
                                                const Cross& cross) {
  for (const Chunk& chunk : chunks) {
    int r = chunk.row - oy;
    if (r < 0) r += ny;
    cross_run(static_cast<std::size_t>(r) * nx, chunk, ox, nx, cross);
  }
}

/// Calls `cross(ray, cell, n)` for every run of at most `lanes` rays from index `ray` in n cells from index `cell`.
/// Segments are those of the level that `step` of the pattern crosses, with cross = begin(segment) for each. For blocks
/// of air it is air = begin_air(segment). Each gets air.enter(cell), air.cross(ray, n) for its runs, and air.leave().
/// These runs have any number of rays. Calls `enter(segment, at)` before a segment that begins at a horizontal face.
/// `at` is the fraction of the level done.
template <class Begin, class BeginAir, class Enter>
inline void cross_level(const PathPattern& pattern, int step, int level, const ActiveRows& rows, const Begin& begin,
                        const BeginAir& begin_air, const Enter& enter) {
  const std::span<const Chunk> chunks = rows.levels.of(level);
  const std::span<const Chunk> gaps = rows.blocks_of(level);
  const int nx = rows.nx;
  const int ny = rows.ny;
  double at = 0;
  for (std::uint32_t s = pattern.level_begin[step]; s < pattern.level_begin[step + 1]; ++s) {
    const Segment& segment = pattern.segments[s];
    if (segment.entry != Entry::none) enter(segment, at);
    at += segment.fraction;
    if (segment.fraction <= 0 || (chunks.empty() && gaps.empty())) continue;
    const int ox = wrapped(segment.shift_x, nx);
    const int oy = wrapped(segment.shift_y, ny);
    const auto cross = begin(segment);
    cross_chunks(chunks, ox, oy, nx, ny, cross);
    if (gaps.empty()) continue;
    auto air = begin_air(segment);
    for (std::size_t g = 0; g < gaps.size();) {
      const std::uint32_t block = gaps[g].cell;
      air.enter(block);
      for (; g < gaps.size() && gaps[g].cell == block; ++g) {
        if (gaps[g].n > nx) {
          air.cross(0, gaps[g].n);
          continue;
        }
        int r = gaps[g].row - oy;
        if (r < 0) r += ny;
        cross_gap(static_cast<std::size_t>(r) * nx, gaps[g], ox, nx, air);
      }
      air.leave();
    }
  }
}

/// Calls `visit(ray)` for the rays that just entered the box through the open side at the beginning of `segment`.
template <class Visit>
inline void for_rays_through_side(const Segment& segment, int nx, int ny, const Visit& visit) {
  if (segment.entry == Entry::x_low || segment.entry == Entry::x_high) {
    const int column = wrapped((segment.entry == Entry::x_low ? 0 : nx - 1) - segment.shift_x, nx);
    for (int r = 0; r < ny; ++r) visit(static_cast<std::size_t>(r) * nx + column);
  } else {
    const int row = wrapped((segment.entry == Entry::y_low ? 0 : ny - 1) - segment.shift_y, ny);
    for (int m = 0; m < nx; ++m) visit(static_cast<std::size_t>(row) * nx + m);
  }
}

/// Calls `run(column, ray, n)` for pieces of rows of an nx x ny plane. In a piece, rays shifted by (shift_x, shift_y)
/// columns modulo the plane are aligned with its columns.
template <class Run>
[[gnu::always_inline]] inline void for_shifted_rows(int shift_x, int shift_y, int nx, int ny, const Run& run) {
  const int sx = wrapped(shift_x, nx);
  const int sy = wrapped(shift_y, ny);
  for (int r = 0; r < ny; ++r) {
    const std::size_t ray = static_cast<std::size_t>(r) * nx;
    const std::size_t column = static_cast<std::size_t>(r + sy < ny ? r + sy : r + sy - ny) * nx;
    run(column + sx, ray, nx - sx);
    if (sx > 0) run(column, ray + (nx - sx), sx);
  }
}

/// The same for the rays in the columns (step_x, step_y) before each column, if rays are shifted by (shift_x, shift_y).
/// Steps are -1 to 1; at the sides of the plane the nearest rays are used.
template <class Run>
inline void for_neighbouring_rows(int shift_x, int shift_y, int step_x, int step_y, int nx, int ny, const Run& run) {
  const auto ray_in = [&](int column, int shift, int n) { return wrapped(std::clamp(column, 0, n - 1) - shift, n); };
  const int begin = std::max(0, step_x);
  const int count = nx - std::abs(step_x);
  for (int r = 0; r < ny; ++r) {
    const std::size_t column = static_cast<std::size_t>(r) * nx;
    const std::size_t ray = static_cast<std::size_t>(ray_in(r - step_y, shift_y, ny)) * nx;
    const int first = ray_in(begin - step_x, shift_x, nx);
    const int before_seam = std::min(count, nx - first);
    if (before_seam > 0) run(column + begin, ray + first, before_seam);
    if (before_seam < count) run(column + begin + before_seam, ray, count - before_seam);
    if (step_x > 0) run(column, ray + ray_in(0, shift_x, nx), 1);
    if (step_x < 0) run(column + nx - 1, ray + ray_in(nx - 1, shift_x, nx), 1);
  }
}

/// Shares rays at fractional position (x, y) columns from their launch column out to the columns they overlap: each ray
/// is as wide as `width` <= 1 columns. `run(column, ray, n, weight)` is called for pieces of rows of an nx x ny plane.
/// Every column is overlapped in full. The part of a ray beyond an open side is lost. If a column at a side lacks a
/// neighbour, its nearest ray replaces it.
template <class Run>
inline void spread_on_columns(double x, double y, double width, int nx, int ny, bool periodic, const Run& run) {
  struct Overlaps {
    int own;                      // column of the ray's middle
    int first;                    // column of the first overlap
    std::array<double, 2> share;  // of it and of the next
  };
  const auto overlaps = [&](double position, int n) -> Overlaps {
    if (n == 1 && periodic) return {0, 0, {1., 0.}};
    const double low = position - width / 2;
    const int first = static_cast<int>(std::floor(low));
    const double share = std::min(1., (first + 1 - low) / width);
    return {static_cast<int>(std::floor(position)), first, {share, 1 - share}};
  };
  const Overlaps along_x = overlaps(x, nx);
  const Overlaps along_y = overlaps(y, ny);
  constexpr double least = 1e-9;  // smaller overlaps are rounding
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      if (along_x.share[i] < least || along_y.share[j] < least) continue;
      const double weight = along_x.share[i] * along_y.share[j];
      const auto weighted = [&](std::size_t column, std::size_t ray, int n) { run(column, ray, n, weight); };
      if (periodic) {
        for_shifted_rows(along_x.first + i, along_y.first + j, nx, ny, weighted);
      } else {
        for_neighbouring_rows(along_x.own, along_y.own, along_x.first + i - along_x.own,
                              along_y.first + j - along_y.own, nx, ny, weighted);
      }
    }
  }
}

/// Sum in a fixed order, whatever the compiler.
template <class Real>
inline double plane_sum(const Real* values, std::size_t n) {
  constexpr std::size_t parts = 8;
  double part[parts] = {};
  std::size_t i = 0;
  for (; i + parts <= n; i += parts) {
    for (std::size_t p = 0; p < parts; ++p) part[p] += static_cast<double>(values[i + p]);
  }
  for (; i < n; ++i) part[0] += static_cast<double>(values[i]);
  double total = 0;
  for (const double p : part) total += p;
  return total;
}

}  // namespace cloudbow
