// Rays cross air: blocks ray by ray, and levels with one block for all rays at once (docs/theory.md, "Layers in
// blocks").
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <type_traits>

#include "transport/rays/cell_kernel.hpp"
#include "transport/rays/ray_rows.hpp"

namespace cloudbow {

/// Rays of one segment cross blocks of air. All have the same optical path, and those of a block its source.
template <class Kind, class Real>
class AirCrossing {
 public:
  /// @param extinction 1/m of the level's air. @param rays of the direction.
  AirCrossing(const SegmentGeometry<Real>& geometry, Real extinction, const MarchedCells<Real>& marched, Real* rays)
      : marched_(marched), rays_(rays), crossing_(optical_path(extinction, geometry.length)), g_(geometry) {
    absorbed_ = crossing_.absorbed();
  }

  /// @param index of the block's cell, among all.
  void enter(std::size_t index) {
    cell_ = index - marched_.first;
    n_ = 0;
    in_ = 0;
    entry_ = exit_ = marched_.source[cell_];
    if constexpr (Kind::linear) {
      const auto& [gradient_x, gradient_y, gradient_z] = marched_.view.gradient;
      const Real x = gradient_x[cell_], y = gradient_y[cell_], z = gradient_z[cell_];
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
      const Real share = g_.share * static_cast<Real>(n_) * marched_.view.share_of_place[cell_];
      const Real held = share * crossing_.mean(in, entry_, exit_);
      marched_.sums.mean[cell_] += held;
      if constexpr (Kind::keep_moments) {
        const Real along = share * crossing_.first_moment(in, entry_, exit_);
        const auto& [moment_x, moment_y, moment_z] = marched_.sums.moment;
        moment_x[cell_] += g_.from_x * held + (g_.to_x - g_.from_x) * along;
        moment_y[cell_] += g_.from_y * held + (g_.to_y - g_.from_y) * along;
        moment_z[cell_] += g_.from_z * held + (g_.to_z - g_.from_z) * along;
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
  MarchedCells<Real> marched_;
  Real* rays_;
  std::size_t cell_ = 0;  // among the marched
  double in_ = 0;         // sum of the radiances that enter the block; sum_ is not yet in it
  Real absorbed_ = 0;
  int n_ = 0;
  Real entry_ = 0, exit_ = 0, emission_ = 0;
  int summed_ = 0;
  Crossing<Real> crossing_;
  SegmentGeometry<Real> g_;
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
  /// @param index of the air's cell, among all.
  AirInSegment(const Segment& segment, double chord, const MarchedCells<Real>& marched, std::size_t index)
      : g_(segment, chord),
        cell_(index - marched.first),
        crossing_(optical_path(static_cast<double>(marched.view.extinction[cell_]), g_.length)),
        entry_(static_cast<double>(marched.source[cell_])),
        exit_(entry_) {
    if constexpr (Kind::linear) {
      const auto& [gradient_x, gradient_y, gradient_z] = marched.view.gradient;
      const double x = gradient_x[cell_], y = gradient_y[cell_], z = gradient_z[cell_];
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
  std::size_t cell_;  // among the marched
  Crossing<double> crossing_;
  double entry_, exit_;
};

/// All rays cross a uniform level.
template <class Kind, class Real>
void cross_uniform_level(const PathPattern& pattern, int step, const ActiveRows& rows,
                         const MarchedCells<Real>& marched, MarchedRays<Real>& rays) {
  const int level = pattern.level(step);
  if (rows.level_cell[level] == rows.level_cell[level + 1]) return;
  for (std::uint32_t s = pattern.level_begin[step]; s < pattern.level_begin[step + 1]; ++s) {
    const AirInSegment<Kind, Real> air(pattern.segments[s], pattern.chord_m[step], marched, rows.level_cell[level]);
    if constexpr (Kind::keep_mean) air.keep(rays.mean(), marched.sums);
    rays.cross_air(air.absorbed(), air.emission());
  }
}

/// Rays cross the cells of a level ray by ray, and its one block of air all at once.
template <class Kind, class Real>
void cross_level_in_air(const PathPattern& pattern, int step, const ActiveRows& rows, const MarchedCells<Real>& marched,
                        Real* stored, MarchedRays<Real>& rays) {
  const int level = pattern.level(step);
  const std::uint32_t block = rows.air[level].first_cell;
  const double n = rows.voxels_end(level) - rows.level_cell[level];
  constexpr std::size_t chunks_summed = 32;
  const std::span<const Chunk> chunks = rows.levels.of(level);
  for (std::uint32_t s = pattern.level_begin[step]; s < pattern.level_begin[step + 1]; ++s) {
    const Segment& segment = pattern.segments[s];
    if (segment.fraction <= 0) continue;
    const AirInSegment<Kind, Real> air(segment, pattern.chord_m[step], marched, block);
    const double all = rays.sum();
    StoredRays after = rays.how();
    after.cross_air(air.absorbed(), air.emission());
    RaysInAir<Real> access(rays.how(), after);
    const SegmentGeometry<Real> geometry(segment, pattern.chord_m[step]);
    const int ox = wrapped(segment.shift_x, rows.nx), oy = wrapped(segment.shift_y, rows.ny);
    for (std::size_t first = 0; first < chunks.size(); first += chunks_summed) {
      cross_chunks(chunks.subspan(first, std::min(chunks_summed, chunks.size() - first)), ox, oy, rows.nx, rows.ny,
                   [&](std::size_t ray, std::size_t cell, int count) {
                     cross_cells<Kind>(geometry, count, marched, cell, stored + ray, access);
                   });
      access.finish_sums();
    }
    if constexpr (Kind::keep_mean)
      air.keep((all - access.entered) / (static_cast<double>(rays.count()) - n), marched.sums);
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

}  // namespace cloudbow
