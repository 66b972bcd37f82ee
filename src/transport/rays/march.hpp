// Marching all rays of one direction through the active cells (docs/theory.md, "Shared pattern"). Rays are identified
// by their launch columns; in a segment of shift (ox, oy) the ray of column (m, r) is in cell (m + ox, r + oy), modulo
// the box. Rays never move in memory.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "transport/grid/cells.hpp"
#include "transport/rays/crossing.hpp"
#include "transport/rays/path_pattern.hpp"
#include "transport/rays/stored_rays.hpp"

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

/// Relative change of a source from face to face of the cells [first, first + n), along x, y and z: central
/// differences, limited so that the linear source stays positive in every cell.
template <class Real>
void source_gradient(const Cells<Real>& cells, std::size_t first, std::size_t n, const Real* source, Real* gradient_x,
                     Real* gradient_y, Real* gradient_z);

/// The same for a source that contains emission, whose slope is known. Differences are of the rest alone.
/// @param rest [n of all cells] the source less the emission.
template <class Real>
void source_gradient(const Cells<Real>& cells, const CellEmission<Real>& emission, std::size_t first, std::size_t n,
                     const Real* source, const Real* rest, Real* gradient_x, Real* gradient_y, Real* gradient_z);

/// 1 / max(the change of a source from the middle of a cell to a corner, the source here): slopes relative to it leave
/// the source positive.
template <class Real>
[[gnu::always_inline]] inline Real limited_inverse(Real x, Real y, Real z, Real here) {
  const Real swing = Real(.5) * (std::abs(x) + std::abs(y) + std::abs(z));
  return here > std::numeric_limits<Real>::min() ? Real(1) / std::max(swing, here) : Real(0);
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

/// Source of all cells along one direction, with its own gradient.
template <class Real>
struct LinearSource {
  std::vector<Real> value;                    ///< [n + lane_padding]
  std::array<std::vector<Real>, 3> gradient;  ///< [n + lane_padding] relative, along x, y, z; empty: constant in cells
  std::vector<Real> from_beam;                ///< [n] its part from the direct beam alone; empty: not needed
  std::vector<Real> rest;                     ///< [n] the source less thermal emission; empty: it has none

  void resize(std::size_t n) { value.resize(n + lane_padding); }
  /// @param emission that the source contains.
  void make_gradient(const Cells<Real>& cells, const CellEmission<Real>& emission = {}) {
    const std::size_t n = cells.size();
    for (auto& axis : gradient) axis.resize(n + lane_padding);
    if (emission.source == nullptr) {
      source_gradient(cells, 0, n, value.data(), gradient[0].data(), gradient[1].data(), gradient[2].data());
      return;
    }
    rest.resize(n);
    for (std::size_t c = 0; c < n; ++c) rest[c] = value[c] - emission.source[c];
    source_gradient(cells, emission, 0, n, value.data(), rest.data(), gradient[0].data(), gradient[1].data(),
                    gradient[2].data());
  }
  CellView<Real> view(const Cells<Real>& cells) const {
    return cells.view(cells.extinction, gradient[0], gradient[1], gradient[2]);
  }
};

/// A segment in the precision of the kernel: its length, its share of the level's chord, and its two ends in the cell.
template <class Real>
struct SegmentGeometry {
  Real length, share;
  Real from_x, from_y, from_z;
  Real to_x, to_y, to_z;

  SegmentGeometry(const Segment& segment, double chord)
      : length(static_cast<Real>(chord * segment.fraction)),
        share(static_cast<Real>(segment.fraction)),
        from_x(static_cast<Real>(segment.from[0])),
        from_y(static_cast<Real>(segment.from[1])),
        from_z(static_cast<Real>(segment.from[2])),
        to_x(static_cast<Real>(segment.to[0])),
        to_y(static_cast<Real>(segment.to[1])),
        to_z(static_cast<Real>(segment.to[2])) {}

  /// Source relative to the cell's mean at both ends of the segment, for a relative gradient (x, y, z) (docs/theory.md,
  /// Eq. 20a).
  template <class Value>
  [[gnu::always_inline]] Value at_entry(const Value& x, const Value& y, const Value& z) const {
    return 1 + from_x * x + from_y * y + from_z * z;
  }
  template <class Value>
  [[gnu::always_inline]] Value at_exit(const Value& x, const Value& y, const Value& z) const {
    return 1 + to_x * x + to_y * y + to_z * z;
  }
};

/// Calls use(std::true_type()) for cells of linear source, else use(std::false_type()): kernels are made for both.
template <class Real, class Use>
[[gnu::always_inline]] inline auto for_source_of(const CellView<Real>& cells, const Use& use) {
  return cells.is_linear() ? use(std::true_type()) : use(std::false_type());
}

/// Calls `use(i, active)` for i = 0 .. count - 1 <= lanes with active = true. In float it continues to the end of a
/// vector of lanes with active = false. Runs of a few cells then cost a vector operation, not a scalar loop. If it is
/// not active, `use` must leave stored values as they were. In double, whose kernels are not vectorised, nothing is
/// added.
template <class Real, class Use>
[[gnu::always_inline]] inline void for_lanes(int count, const Use& use) {
  if constexpr (std::is_same_v<Real, float>) {
#pragma omp simd
    for (int i = 0; i < lanes; ++i) use(i, i < count);
  } else {
    for (int i = 0; i < count; ++i) use(i, true);
  }
}

/// The same for any number of rays.
template <class Real, class Use>
[[gnu::always_inline]] inline void for_rays(int count, const Use& use) {
  if constexpr (std::is_same_v<Real, float>) {
    const int whole = count / lanes * lanes;
#pragma omp simd
    for (int i = 0; i < whole; ++i) use(i, true);
    if (whole == count) return;
#pragma omp simd
    for (int i = 0; i < lanes; ++i) use(whole + i, whole + i < count);
  } else {
    for (int i = 0; i < count; ++i) use(i, true);
  }
}

/// Sums over rays in the cells [n + lane_padding] that they cross. Rays add to them; null: not kept.
template <class Real>
struct CellSums {
  Real* mean = nullptr;           ///< voxel-mean radiance
  std::array<Real*, 3> moment{};  ///< its first moments along the march's axes, in cell sizes from the cell's centre

  bool keeps_moments() const { return moment[0] != nullptr; }
};

/// The work of a kernel, known when it is compiled.
template <bool with_mean, bool with_moments, bool with_linear_source>
struct CrossingKind {
  static constexpr bool keep_mean = with_mean;
  static constexpr bool keep_moments = with_moments;  ///< only of a linear source
  static constexpr bool linear = with_linear_source;
};

/// Calls use(kind) with the CrossingKind that the cells and sums require.
template <bool keep_mean, class Real, class Use>
[[gnu::always_inline]] inline auto for_kind_of(const CellView<Real>& cells, const CellSums<Real>& sums,
                                               const Use& use) {
  if (!cells.is_linear()) return use(CrossingKind<keep_mean, false, false>());
  if (keep_mean && sums.keeps_moments()) return use(CrossingKind<keep_mean, keep_mean, true>());
  return use(CrossingKind<keep_mean, false, true>());
}

/// `count` <= lanes rays cross as many cells. In float all arrays can be read and written up to lane_padding elements
/// beyond.
/// @param access how rays are stored: PlainRays or RaysInAir.
template <class Kind, class Real, class Access>
[[gnu::always_inline]] inline void cross_cells(const SegmentGeometry<Real>& g, int count, const CellView<Real>& cells,
                                               std::size_t cell, const Real* source, Real* ray,
                                               const CellSums<Real>& sums, Access&& access) {
  using Cell = Pack<Real>;
  using Value = typename Cell::Value;
  const auto active = Cell::first(count);
  for (int i = 0; i < Cell::steps(count); ++i) {
    const auto add = [&](const Value& more, Real* to) { Cell::store(active, Cell::load(to) + more, to); };
    const Crossing<Value> crossing(optical_path(Cell::load(cells.extinction + cell + i), g.length));
    const Value s = Cell::load(source + cell + i);
    const Value in = access.radiance(Cell::load(ray + i));
    Value out, held;
    if constexpr (Kind::linear) {
      const Value x = Cell::load(cells.gradient[0] + cell + i);
      const Value y = Cell::load(cells.gradient[1] + cell + i);
      const Value z = Cell::load(cells.gradient[2] + cell + i);
      const Value entry = s * g.at_entry(x, y, z);
      const Value exit = s * g.at_exit(x, y, z);
      held = g.share * crossing.mean(in, entry, exit);
      out = crossing.leaving(in, crossing.emitted(entry, exit));
      if constexpr (Kind::keep_moments) {
        const Value along = g.share * crossing.first_moment(in, entry, exit);
        add(g.from_x * held + (g.to_x - g.from_x) * along, sums.moment[0] + cell + i);
        add(g.from_y * held + (g.to_y - g.from_y) * along, sums.moment[1] + cell + i);
        add(g.from_z * held + (g.to_z - g.from_z) * along, sums.moment[2] + cell + i);
      }
    } else {
      held = g.share * crossing.mean_constant(in, s);
      out = crossing.leaving_constant(in, s);
    }
    if constexpr (Kind::keep_mean) add(held, sums.mean + cell + i);
    access.note(active, in, out);
    Cell::store(active, access.stored(out), ray + i);
  }
}

/// Rays of one segment cross blocks of air. All have the same optical path, and those of a block its source.
template <class Kind, class Real>
class AirCrossing {
 public:
  /// @param extinction 1/m of the level's air. @param rays of the direction; the others as for cross_cells().
  AirCrossing(const SegmentGeometry<Real>& geometry, Real extinction, const CellView<Real>& cells, const Real* source,
              Real* rays, const CellSums<Real>& sums)
      : source_(source),
        rays_(rays),
        sums_(sums),
        cells_(cells),
        crossing_(optical_path(extinction, geometry.length)),
        g_(geometry) {
    absorbed_ = crossing_.absorbed();
  }

  void enter(std::size_t cell) {
    cell_ = cell;
    n_ = 0;
    in_ = 0;
    entry_ = exit_ = source_[cell];
    if constexpr (Kind::linear) {
      const Real x = cells_.gradient[0][cell], y = cells_.gradient[1][cell], z = cells_.gradient[2][cell];
      entry_ *= g_.at_entry(x, y, z);
      exit_ *= g_.at_exit(x, y, z);
    }
    emission_ = crossing_.t * crossing_.emitted(entry_, exit_);
  }

  [[gnu::always_inline]] void cross(std::size_t ray, int n) {
    n_ += n;
    for (int begin = 0; begin < n; begin += rays_summed)
      cross_some(rays_ + ray + begin, std::min(rays_summed, n - begin));
  }

  void leave() {
    if constexpr (Kind::keep_mean) {
      finish_sum();
      const Real in = static_cast<Real>(in_ / n_);
      const Real share = g_.share * static_cast<Real>(n_) * cells_.share_of_place[cell_];
      const Real held = share * crossing_.mean(in, entry_, exit_);
      sums_.mean[cell_] += held;
      if constexpr (Kind::keep_moments) {
        const Real along = share * crossing_.first_moment(in, entry_, exit_);
        sums_.moment[0][cell_] += g_.from_x * held + (g_.to_x - g_.from_x) * along;
        sums_.moment[1][cell_] += g_.from_y * held + (g_.to_y - g_.from_y) * along;
        sums_.moment[2][cell_] += g_.from_z * held + (g_.to_z - g_.from_z) * along;
      }
    }
  }

 private:
  using Rays = Pack<Real>;
  // Sums of more rays would lose digits in float.
  static constexpr int rays_summed = std::is_same_v<Real, float> ? 32 * lanes : 1;

  [[gnu::always_inline]] void cross_some(Real* from, int n) {
    int i = 0;
    for (; i + Rays::size <= n; i += Rays::size) {
      const auto in = Rays::load(from + i);
      sum_ += in;
      Rays::store_all(in + (emission_ - absorbed_ * in), from + i);
    }
    if (i < n) {
      const auto active = Rays::first(n - i);
      const auto in = Rays::load(from + i);
      sum_ += Rays::masked(active, in);
      Rays::store(active, in + (emission_ - absorbed_ * in), from + i);
    }
    summed_ += n;
    if (summed_ >= rays_summed) finish_sum();
  }
  void finish_sum() {
    in_ += static_cast<double>(Rays::sum(sum_));
    sum_ = typename Rays::Value{};
    summed_ = 0;
  }

  typename Rays::Value sum_{};  // the last rays that enter
  const Real* source_;
  Real* rays_;
  std::size_t cell_ = 0;
  double in_ = 0;  // sum of the radiances that enter the block; sum_ is not yet in it
  CellSums<Real> sums_;
  CellView<Real> cells_;
  Real absorbed_ = 0;
  int n_ = 0;
  Real entry_ = 0, exit_ = 0, emission_ = 0;
  int summed_ = 0;
  Crossing<Real> crossing_;
  SegmentGeometry<Real> g_;
};

/// Prefetches the data of a later chunk in a list: the processor does not prefetch short runs of cells by itself.
template <class Kind, class Real>
[[gnu::always_inline]] inline void ask_for(const Chunk* chunk, const CellView<Real>& cells, const Real* source,
                                           const CellSums<Real>& sums) {
  const std::size_t cell = chunk->cell;
  __builtin_prefetch(cells.extinction + cell);
  __builtin_prefetch(source + cell);
  if constexpr (Kind::linear) {
    for (const Real* gradient : cells.gradient) __builtin_prefetch(gradient + cell);
  }
  if constexpr (Kind::keep_mean) __builtin_prefetch(sums.mean + cell, 1);
  if constexpr (Kind::keep_moments) {
    for (const Real* moment : sums.moment) __builtin_prefetch(moment + cell, 1);
  }
}

/// Results of one direction's march.
struct MarchTotals {
  double entered_sides = 0;  ///< sum of radiances of the rays that came in through open sides
  double left_sides = 0;
};

/// Rays of a direction in a periodic box, as levels of air need them.
template <class Real>
class MarchedRays {
 public:
  MarchedRays(Real* rays, const ActiveRows& rows)
      : rays_(rays), count_(static_cast<std::size_t>(rows.nx) * static_cast<std::size_t>(rows.ny)) {}

  const StoredRays& how() const { return how_; }
  std::size_t count() const { return count_; }
  double sum() {
    if (!sum_is_known_) sum_ = plane_sum(rays_, count_);
    sum_is_known_ = true;
    return how_.scale * sum_ + how_.offset * static_cast<double>(count_);
  }
  double mean() { return sum() / static_cast<double>(count_); }
  void cross_air(double absorbed, double emission) { how_.cross_air(absorbed, emission); }
  /// A segment in which the rest of the rays crossed n cells. sum() was called before.
  void cross_segment(const StoredRays& after, double n, double entered, double left) {
    sum_ += (left - n * after.offset) / after.scale - (entered - n * how_.offset) / how_.scale;
    how_ = after;
  }
  /// The stored values become the radiances.
  void write() {
    if (sum_is_known_) sum_ = sum();
    how_.write(rays_, count_);
  }
  /// Others are about to change the rays.
  void forget_sum() { sum_is_known_ = false; }

 private:
  Real* rays_;
  std::size_t count_;
  StoredRays how_;
  double sum_ = 0;  // of the stored values
  bool sum_is_known_ = false;
};

/// A level's air along one segment: its one source, and the mean radiance that it holds.
template <class Kind, class Real>
class AirInSegment {
 public:
  /// @param cell of the air.
  AirInSegment(const Segment& segment, double chord, const CellView<Real>& cells, const Real* source, std::size_t cell)
      : g_(segment, chord),
        crossing_(optical_path(static_cast<double>(cells.extinction[cell]), g_.length)),
        cell_(cell),
        entry_(static_cast<double>(source[cell])),
        exit_(entry_) {
    if constexpr (Kind::linear) {
      const double x = cells.gradient[0][cell], y = cells.gradient[1][cell], z = cells.gradient[2][cell];
      entry_ *= g_.at_entry(x, y, z);
      exit_ *= g_.at_exit(x, y, z);
    }
  }

  double absorbed() const { return crossing_.absorbed(); }
  double emission() const { return crossing_.t * crossing_.emitted(entry_, exit_); }
  /// @param in mean radiance of all its rays.
  void keep(double in, const CellSums<Real>& sums) const {
    if constexpr (Kind::keep_mean) {
      const double held = g_.share * crossing_.mean(in, entry_, exit_);
      sums.mean[cell_] += static_cast<Real>(held);
      if constexpr (Kind::keep_moments) {
        const double along = g_.share * crossing_.first_moment(in, entry_, exit_);
        sums.moment[0][cell_] += static_cast<Real>(g_.from_x * held + (g_.to_x - g_.from_x) * along);
        sums.moment[1][cell_] += static_cast<Real>(g_.from_y * held + (g_.to_y - g_.from_y) * along);
        sums.moment[2][cell_] += static_cast<Real>(g_.from_z * held + (g_.to_z - g_.from_z) * along);
      }
    }
  }

 private:
  SegmentGeometry<double> g_;
  Crossing<double> crossing_;
  std::size_t cell_;
  double entry_, exit_;
};

/// All rays cross a uniform level.
template <class Kind, class Real>
void cross_uniform_level(const PathPattern& pattern, int step, const ActiveRows& rows, const CellView<Real>& cells,
                         const Real* source, const CellSums<Real>& sums, MarchedRays<Real>& rays) {
  const int level = pattern.level(step);
  if (rows.level_cell[level] == rows.level_cell[level + 1]) return;
  for (std::uint32_t s = pattern.level_begin[step]; s < pattern.level_begin[step + 1]; ++s) {
    const AirInSegment<Kind, Real> air(pattern.segments[s], pattern.chord_m[step], cells, source,
                                       rows.level_cell[level]);
    if constexpr (Kind::keep_mean) air.keep(rays.mean(), sums);
    rays.cross_air(air.absorbed(), air.emission());
  }
}

/// Rays cross the cells of a level ray by ray, and its one block of air all at once.
template <class Kind, class Real>
void cross_level_in_air(const PathPattern& pattern, int step, const ActiveRows& rows, const CellView<Real>& cells,
                        const Real* source, const CellSums<Real>& sums, Real* stored, MarchedRays<Real>& rays) {
  const int level = pattern.level(step);
  const std::uint32_t block = rows.air[level].first_cell;
  const double n = rows.voxels_end(level) - rows.level_cell[level];
  constexpr std::size_t chunks_summed = 32;
  const std::span<const Chunk> chunks = rows.levels.of(level);
  for (std::uint32_t s = pattern.level_begin[step]; s < pattern.level_begin[step + 1]; ++s) {
    const Segment& segment = pattern.segments[s];
    if (segment.fraction <= 0) continue;
    const AirInSegment<Kind, Real> air(segment, pattern.chord_m[step], cells, source, block);
    const double all = rays.sum();
    StoredRays after = rays.how();
    after.cross_air(air.absorbed(), air.emission());
    RaysInAir<Real> access(rays.how(), after);
    const SegmentGeometry<Real> geometry(segment, pattern.chord_m[step]);
    const int ox = wrapped(segment.shift_x, rows.nx), oy = wrapped(segment.shift_y, rows.ny);
    for (std::size_t first = 0; first < chunks.size(); first += chunks_summed) {
      cross_chunks(chunks.subspan(first, std::min(chunks_summed, chunks.size() - first)), ox, oy, rows.nx, rows.ny,
                   [&](std::size_t ray, std::size_t cell, int count) {
                     cross_cells<Kind>(geometry, count, cells, cell, source, stored + ray, sums, access);
                   });
      access.finish_sums();
    }
    if constexpr (Kind::keep_mean) air.keep((all - access.entered) / (static_cast<double>(rays.count()) - n), sums);
    rays.cross_segment(after, n, access.entered, access.left);
  }
}

/// Whether all rays of a periodic box may cross the air of this level at once. Opaque air leaves no digits of the rays
/// that are stored, so it must not stand beside cells.
template <class Real>
bool crosses_in_air(const PathPattern& pattern, int step, const ActiveRows& rows, const CellView<Real>& cells) {
  constexpr double thickest = 1;
  const int level = pattern.level(step);
  if (rows.is_uniform(level)) return true;
  return rows.is_mostly_air(level) &&
         static_cast<double>(cells.extinction[rows.air[level].first_cell]) * pattern.chord_m[step] < thickest;
}

/// Whether what is stored has the digits of the radiances, of dim rays too.
template <class Real>
bool keeps_digits(MarchedRays<Real>& rays) {
  constexpr double least_scale = .25, largest_offset = .25;
  const StoredRays& how = rays.how();
  return how.scale >= least_scale && std::abs(how.offset) <= largest_offset * std::abs(rays.mean());
}

/// One direction through the levels of its pattern. `source` [n] is that of the cells, `rays` [nx*ny] hold the radiance
/// at the start and at the end; all arrays with lane_padding more behind them. at_level(step, rays, all) is called
/// before the first level and after each. `rays` is null if they are not stored as they are; all.sum() is theirs.
/// @param side_radiance [levels + 1] in marching order: radiance coming in through open sides at each interface; empty:
/// none.
/// @param joins whether `rays` may be null then.
/// @param sums read only if keep_mean.
template <class Real, bool keep_mean, class AtLevel>
MarchTotals march(const PathPattern& pattern, const ActiveRows& rows, const CellView<Real>& cells, bool periodic,
                  std::span<const Real> side_radiance, const Real* source, Real* rays, bool joins,
                  const CellSums<Real>& sums, const AtLevel& at_level) {
  MarchTotals totals;
  MarchedRays<Real> all(rays, rows);
  at_level(0, rays, all);
  for (int step = 0; step < pattern.levels(); ++step) {
    const int level = pattern.level(step);
    if (joins && periodic && crosses_in_air(pattern, step, rows, cells)) {
      const bool is_uniform = rows.is_uniform(level);
      if (!is_uniform && !keeps_digits(all)) all.write();
      for_kind_of<keep_mean>(cells, sums, [&](auto kind) {
        if (is_uniform) {
          cross_uniform_level<decltype(kind)>(pattern, step, rows, cells, source, sums, all);
        } else {
          cross_level_in_air<decltype(kind)>(pattern, step, rows, cells, source, sums, rays, all);
        }
      });
      at_level(step + 1, nullptr, all);
      continue;
    }
    all.write();
    all.forget_sum();
    const double chord = pattern.chord_m[step];
    const auto enter = [&](const Segment& segment, double at) {
      if (periodic) return;
      const Real outside = side_radiance.empty()
                               ? Real(0)
                               : static_cast<Real>((1 - at) * side_radiance[step] + at * side_radiance[step + 1]);
      for_rays_through_side(segment, rows.nx, rows.ny, [&](std::size_t ray) {
        totals.left_sides += rays[ray];
        totals.entered_sides += outside;
        rays[ray] = outside;
      });
    };
    for_kind_of<keep_mean>(cells, sums, [&](auto kind) {
      const auto begin = [&](const Segment& segment) {
        return [=, geometry = SegmentGeometry<Real>(segment, chord)](std::size_t ray, std::size_t cell, int count) {
          cross_cells<decltype(kind)>(geometry, count, cells, cell, source, rays + ray, sums, PlainRays());
        };
      };
      const auto begin_air = [&](const Segment& segment) {
        const Real extinction = cells.extinction[rows.air[pattern.level(step)].first_cell];
        return AirCrossing<decltype(kind), Real>(SegmentGeometry<Real>(segment, chord), extinction, cells, source, rays,
                                                 sums);
      };
      cross_level(pattern, step, pattern.level(step), rows, begin, begin_air, enter);
    });
    at_level(step + 1, rays, all);
  }
  all.write();
  return totals;
}

}  // namespace cloudbow
