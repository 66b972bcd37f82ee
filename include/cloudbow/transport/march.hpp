// Marching all rays of one direction through the active cells (docs/theory.md, "Shared pattern"). A ray is known by its
// launch column; in a segment of shift (ox, oy) the ray of column (m, r) is in cell (m + ox, r + oy), modulo the box.
// Rays never move in memory.
#pragma once

#include <span>
#include <type_traits>
#include <vector>

#include "cloudbow/transport/cells.hpp"
#include "cloudbow/transport/exponential_functions.hpp"
#include "cloudbow/transport/path_pattern.hpp"

namespace cloudbow {

inline int wrapped(int i, int n) {
  const int r = i % n;
  return r < 0 ? r + n : r;
}

/// Calls `kernel(ray, cell, n, segment)` for every run of n rays from index `ray` that lie in n cells from index
/// `cell`, segment by segment of the level that `step` of the pattern crosses, and `enter(segment, at)` before a
/// segment that begins at a horizontal face, at = fraction of the level done.
template <class Kernel, class Enter>
inline void cross_level(const PathPattern& pattern, int step, int level, const ActiveRows& rows, const Kernel& kernel,
                        const Enter& enter) {
  const std::uint32_t first_row = rows.level_row[level];
  const std::uint32_t last_row = rows.level_row[level + 1];
  const int nx = rows.nx;
  double at = 0;
  for (std::uint32_t s = pattern.level_begin[step]; s < pattern.level_begin[step + 1]; ++s) {
    const Segment& segment = pattern.segments[s];
    if (segment.entry != Entry::none) enter(segment, at);
    at += segment.fraction;
    if (segment.fraction <= 0) continue;
    const int ox = wrapped(segment.shift_x, nx);
    const int oy = wrapped(segment.shift_y, rows.ny);
    for (std::uint32_t q = first_row; q < last_row; ++q) {
      const ActiveRow& row = rows.rows[q];
      int r = row.j - oy;
      if (r < 0) r += rows.ny;
      const std::size_t ray_row = static_cast<std::size_t>(r) * nx;
      for (std::uint32_t t = row.first_span; t < row.last_span; ++t) {
        const RowSpan& span = rows.spans[t];
        int m = span.i - ox;
        if (m < 0) m += nx;
        const int before_wrap = std::min(span.n, nx - m);
        kernel(ray_row + m, span.offset, before_wrap, segment);
        if (before_wrap < span.n) kernel(ray_row, span.offset + before_wrap, span.n - before_wrap, segment);
      }
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

/// Adds rays that leave a level at fractional position (x, y) columns from their launch column to the columns they
/// overlap: each ray is as wide as `width` columns. Call with n = nx*ny values; `add(column, ray, weight)`.
template <class Add>
inline void spread_on_columns(double x, double y, double width, int nx, int ny, bool periodic, const Add& add) {
  struct Overlap {
    int shift;
    double weight;
  };
  const auto overlaps = [&](double position, int n) {
    std::vector<Overlap> list;
    if (n == 1 && periodic) return std::vector<Overlap>{{0, 1.}};
    const double low = position - width / 2;
    const double high = position + width / 2;
    for (int c = static_cast<int>(std::floor(low)); c < high; ++c) {
      const double share = (std::min(high, c + 1.) - std::max(low, static_cast<double>(c))) / width;
      if (share > 1e-9) list.push_back({c, share});
    }
    return list;
  };
  for (const Overlap& oy : overlaps(y, ny)) {
    for (const Overlap& ox : overlaps(x, nx)) {
      const int sx = wrapped(ox.shift, nx);
      const int sy = wrapped(oy.shift, ny);
      const double weight = ox.weight * oy.weight;
      for (int r = 0; r < ny; ++r) {
        const int j = r + sy < ny ? r + sy : r + sy - ny;
        for (int m = 0; m < nx; ++m) {
          const int i = m + sx < nx ? m + sx : m + sx - nx;
          add(static_cast<std::size_t>(j) * nx + i, static_cast<std::size_t>(r) * nx + m, weight);
        }
      }
    }
  }
}

/// Slopes of a source over the cells [first, first + n), limited so that the linear source stays positive in every
/// cell.
template <class Real>
void source_slopes(const Cells<Real>& cells, std::size_t first, std::size_t n, const Real* source, Real* slope_x,
                   Real* slope_y, Real* slope_z);

/// A segment in the precision of the kernel: its length, its share of the level's chord, and where in the cell it
/// begins and ends.
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
};

/// Calls `use(i, active)` for i = 0 .. count - 1 with active = true, and in float beyond that, to the end of a vector
/// of lanes, with active = false: runs of a few cells then cost a vector operation, not a scalar loop. What `use`
/// writes where it is not active must be what was there. In double, whose kernels are not vectorised, nothing is added.
template <class Real, class Use>
[[gnu::always_inline]] inline void for_lanes(int count, const Use& use) {
  if constexpr (std::is_same_v<Real, float>) {
    for (int first = 0; first < count; first += lanes) {
#pragma omp simd
      for (int i = 0; i < lanes; ++i) use(first + i, first + i < count);
    }
  } else {
    for (int i = 0; i < count; ++i) use(i, true);
  }
}

/// `count` rays cross `count` cells of linear source (S1 where they enter, S2 where they leave; docs/theory.md, "March
/// along a ray"):
///   I_out  = I_in + t [phi2 S2 + (phi1 - phi2) S1 - phi1 I_in]
///   I_mean = phi1 I_in + t [(phi2 - phi3) S1 + phi3 S2]
/// In float all arrays can be read and written up to lane_padding elements beyond.
template <class Real, bool keep_mean>
inline void cross_cells(const SegmentGeometry<Real> g, int count, const Real* __restrict extinction,
                        const Real* __restrict source, const Real* __restrict slope_x, const Real* __restrict slope_y,
                        const Real* __restrict slope_z, Real* __restrict ray, Real* __restrict mean) {
  for_lanes<Real>(count, [=](int i, bool active) {
    const Real t = std::min(extinction[i] * g.length, static_cast<Real>(largest_optical_path));
    const ExponentialFunctions<Real> phi = exponential_functions(t);
    const Real entry = source[i] + g.from_x * slope_x[i] + g.from_y * slope_y[i] + g.from_z * slope_z[i];
    const Real exit = source[i] + g.to_x * slope_x[i] + g.to_y * slope_y[i] + g.to_z * slope_z[i];
    const Real in = ray[i];
    if constexpr (keep_mean) {
      const Real more = g.share * (phi.phi1 * in + t * ((phi.phi2 - phi.phi3) * entry + phi.phi3 * exit));
      mean[i] = active ? mean[i] + more : mean[i];
    }
    const Real out = in + t * (phi.phi2 * exit + (phi.phi1 - phi.phi2) * entry - phi.phi1 * in);
    ray[i] = active ? out : in;
  });
}

/// What one direction's march left behind.
struct MarchTotals {
  double entered_sides = 0;  ///< sum of radiances of the rays that came in through open sides
  double left_sides = 0;
};

/// Work space of one thread.
template <class Real>
struct MarchWorkspace {
  std::vector<Real> slope_x, slope_y, slope_z;
  std::array<std::vector<Real>, 2> mean;
};

/// One direction through all levels. `source` [n] becomes the voxel-mean radiance if keep_mean; `rays` [nx*ny] hold the
/// radiance at the start and at the end; both with lane_padding more behind them. at_level(step, rays) is called before
/// the first level and after each.
/// @param side_radiance [nz + 1] in marching order: radiance coming in through open sides at each interface; empty:
/// none.
template <class Real, bool keep_mean, class AtLevel>
MarchTotals march(const PathPattern& pattern, const Cells<Real>& cells, bool periodic,
                  std::span<const Real> side_radiance, Real* source, Real* rays, MarchWorkspace<Real>& work,
                  const AtLevel& at_level) {
  const ActiveRows& rows = cells.rows;
  MarchTotals totals;
  const std::size_t largest = rows.largest_level();
  for (auto* v : {&work.slope_x, &work.slope_y, &work.slope_z, &work.mean[0], &work.mean[1]})
    v->resize(largest + lane_padding);
  at_level(0, rays);
  int previous = -1;  // level whose mean waits to replace its source: its neighbour's slopes still need the source
  const auto flush = [&] {
    if (keep_mean && previous >= 0) {
      std::copy_n(work.mean[previous & 1].data(), rows.level_cell[previous + 1] - rows.level_cell[previous],
                  source + rows.level_cell[previous]);
    }
  };
  for (int step = 0; step < pattern.levels(); ++step) {
    const int level = pattern.level(step);
    const std::size_t first = rows.level_cell[level];
    const std::size_t n = rows.level_cell[level + 1] - first;
    if (n > 0) source_slopes(cells, first, n, source, work.slope_x.data(), work.slope_y.data(), work.slope_z.data());
    flush();
    previous = level;
    Real* const mean = work.mean[level & 1].data();
    if (keep_mean) std::fill_n(mean, n, Real(0));
    const double chord = pattern.chord_m[step];
    const auto kernel = [&](std::size_t ray, std::size_t cell, int count, const Segment& segment) {
      const std::size_t here = cell - first;
      cross_cells<Real, keep_mean>({segment, chord}, count, cells.extinction.data() + cell, source + cell,
                                   work.slope_x.data() + here, work.slope_y.data() + here, work.slope_z.data() + here,
                                   rays + ray, mean + here);
    };
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
    cross_level(pattern, step, level, rows, kernel, enter);
    at_level(step + 1, rays);
  }
  flush();
  return totals;
}

}  // namespace cloudbow
