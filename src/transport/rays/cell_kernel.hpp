// Rays cross cells, eight at a time (docs/theory.md, "March along a ray").
#pragma once

#include <array>
#include <type_traits>

#include "transport/grid/cells.hpp"
#include "transport/rays/crossing.hpp"
#include "transport/rays/path_pattern.hpp"
#include "transport/rays/stored_rays.hpp"

namespace cloudbow {

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

/// Cells as a march reads them, with their source and sums. The index 0 of all arrays is that of the cell `first`.
template <class Real>
struct MarchedCells {
  std::size_t first = 0;  ///< among all cells
  CellView<Real> view;
  const Real* source;
  CellSums<Real> sums{};

  /// The same from one of these cells on.
  MarchedCells from(std::size_t cell) const {
    const std::size_t by = cell - first;
    const auto later = [by](auto* of) { return of != nullptr ? of + by : nullptr; };
    CellView<Real> view_from(view.extinction + by, {});
    for (std::size_t axis = 0; axis < 3; ++axis) view_from.gradient[axis] = later(view.gradient[axis]);
    view_from.share_of_place = later(view.share_of_place);
    CellSums<Real> sums_from{later(sums.mean), {}};
    for (std::size_t axis = 0; axis < 3; ++axis) sums_from.moment[axis] = later(sums.moment[axis]);
    return {cell, view_from, source + by, sums_from};
  }
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
/// @param index of the first cell, among all.
/// @param access how rays are stored: PlainRays or RaysInAir.
template <class Kind, class Real, class Access>
[[gnu::always_inline]] inline void cross_cells(const SegmentGeometry<Real>& g, int count,
                                               const MarchedCells<Real>& marched, std::size_t index, Real* ray,
                                               Access&& access) {
  const CellView<Real>& cells = marched.view;
  const CellSums<Real>& sums = marched.sums;
  const std::size_t cell = index - marched.first;
  using Cell = Pack<Real>;
  using Value = typename Cell::Value;
  const auto active = Cell::first(count);
  for (int i = 0; i < Cell::steps(count); ++i) {
    const auto add = [&](const Value& more, Real* to) { Cell::store(active, Cell::load(to) + more, to); };
    const Crossing<Value> crossing(optical_path(Cell::load(cells.extinction + cell + i), g.length));
    const Value s = Cell::load(marched.source + cell + i);
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

}  // namespace cloudbow
