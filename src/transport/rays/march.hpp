// Marching all rays of one direction through the active cells, and the source that they see.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "transport/rays/air_march.hpp"

namespace cloudbow {

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

/// Prefetches the data of a later chunk in a list: the processor does not prefetch short runs of cells by itself.
template <class Kind, class Real>
[[gnu::always_inline]] inline void ask_for(const Chunk* chunk, const MarchedCells<Real>& marched) {
  const std::size_t cell = chunk->cell - marched.first;
  __builtin_prefetch(marched.view.extinction + cell);
  __builtin_prefetch(marched.source + cell);
  if constexpr (Kind::linear) {
    for (const Real* gradient : marched.view.gradient) __builtin_prefetch(gradient + cell);
  }
  if constexpr (Kind::keep_mean) __builtin_prefetch(marched.sums.mean + cell, 1);
  if constexpr (Kind::keep_moments) {
    for (const Real* moment : marched.sums.moment) __builtin_prefetch(moment + cell, 1);
  }
}

/// Results of one direction's march.
struct MarchTotals {
  double entered_sides = 0;  ///< sum of radiances of the rays that came in through open sides
  double left_sides = 0;
};

/// One direction through the levels of its pattern. `rays` [nx*ny] hold the radiance at the start and at the end, with
/// lane_padding more behind them. at_level(step, rays, all) is called before the first level and after each. `rays` is
/// null if they are not stored as they are; all.sum() is theirs.
/// @param extinction [n] of all cells.
/// @param of_level(level) gives the MarchedCells of a level. It is called when the march comes to the level: what it
/// makes is then in the nearest caches. Arrays have lane_padding more behind the level's cells.
/// @param side_radiance [levels + 1] in marching order: radiance coming in through open sides at each interface; empty:
/// none.
/// @param joins whether `rays` may be null then.
template <class Real, bool keep_mean, class OfLevel, class AtLevel>
MarchTotals march_by_level(const PathPattern& pattern, const ActiveRows& rows, const Real* extinction, bool periodic,
                           std::span<const Real> side_radiance, const OfLevel& of_level, Real* rays, bool joins,
                           const AtLevel& at_level) {
  MarchTotals totals;
  MarchedRays<Real> all(rays, rows);
  const CellView<Real> all_cells(extinction, {});
  at_level(0, rays, all);
  for (int step = 0; step < pattern.levels(); ++step) {
    const int level = pattern.level(step);
    const MarchedCells<Real> marched = of_level(level);
    if (joins && periodic && crosses_in_air(pattern, step, rows, all_cells)) {
      const bool is_uniform = rows.is_uniform(level);
      if (!is_uniform && !keeps_digits(all)) all.write();
      for_kind_of<keep_mean>(marched.view, marched.sums, [&](auto kind) {
        if (is_uniform) {
          cross_uniform_level<decltype(kind)>(pattern, step, rows, marched, all);
        } else {
          cross_level_in_air<decltype(kind)>(pattern, step, rows, marched, rays, all);
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
    for_kind_of<keep_mean>(marched.view, marched.sums, [&](auto kind) {
      const auto begin = [&](const Segment& segment) {
        return [=, geometry = SegmentGeometry<Real>(segment, chord)](std::size_t ray, std::size_t cell, int count) {
          cross_cells<decltype(kind)>(geometry, count, marched, cell, rays + ray, PlainRays());
        };
      };
      const auto begin_air = [&](const Segment& segment) {
        return AirCrossing<decltype(kind), Real>(SegmentGeometry<Real>(segment, chord),
                                                 extinction[rows.air[level].first_cell], marched, rays);
      };
      cross_level(pattern, step, pattern.level(step), rows, begin, begin_air, enter);
    });
    at_level(step + 1, rays, all);
  }
  all.write();
  return totals;
}

/// The same with arrays of all cells at hand. @param sums used only if keep_mean.
template <class Real, bool keep_mean, class AtLevel>
MarchTotals march(const PathPattern& pattern, const ActiveRows& rows, const CellView<Real>& cells, bool periodic,
                  std::span<const Real> side_radiance, const Real* source, Real* rays, bool joins,
                  const CellSums<Real>& sums, const AtLevel& at_level) {
  const MarchedCells<Real> all{0, cells, source, sums};
  return march_by_level<Real, keep_mean>(
      pattern, rows, cells.extinction, periodic, side_radiance, [&](int) { return all; }, rays, joins, at_level);
}

}  // namespace cloudbow
