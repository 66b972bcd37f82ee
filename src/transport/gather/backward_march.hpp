// One direction's light, marched backwards from a plane: the light that its cells send there, and that from beyond.
#pragma once

#include <algorithm>
#include <vector>

#include "transport/gather/air_source.hpp"
#include "transport/gather/gather.hpp"
#include "transport/gather/source_gradients.hpp"

namespace cloudbow {

/// Levels, in marching order, whose light is booked together.
struct Band {
  int first_step;
  int last_step;                 ///< exclusive
  double distance_m;             ///< of its middle from the plane
  bool empty;                    ///< no light comes from it
  bool same_everywhere = false;  ///< its light does not vary over the plane
};

/// Sums for rays that leave a plane, one per column.
template <class Real>
struct Gathered {
  std::vector<std::vector<Real>> of_band;  ///< [bands][columns + lane_padding] light of the cells
  std::vector<Real> beyond;                ///< [columns] light from beyond the last level or the sides

  void clear(std::size_t bands, std::size_t columns) {
    of_band.resize(bands);
    for (auto& band : of_band) band.assign(columns + lane_padding, Real(0));
    beyond.assign(columns, Real(0));
  }
};

template <class Real>
struct GatherWorkspace {
  SourceByLevel<Real> source;
  std::vector<Real> transmitted, ground;
  std::vector<Real> at_band;  // transmitted, at the beginning of a band
};

/// Rays of a backward march: transmission = scale * stored, and the light seen in a band = its sum + seen * stored. Air
/// between clouds changes these two numbers, and no ray (docs/theory.md, "Rays in air").
struct StoredSight {
  double scale = 1;
  double seen = 0;

  /// @param emission of the air, seen from its end, per transmission.
  void cross_air(double absorbed, double emission) {
    seen += scale * emission;
    scale -= scale * absorbed;
  }
  template <class Real>
  void finish_band(const Real* __restrict stored, Real* __restrict sum, std::size_t n) {
    if (seen == 0) return;
    const Real by = static_cast<Real>(seen);
#pragma omp simd
    for (std::size_t m = 0; m < n; ++m) sum[m] += by * stored[m];
    seen = 0;
  }
  /// Makes the stored values the transmissions, between bands.
  template <class Real>
  void write(Real* stored, std::size_t n) {
    if (scale == 1) return;
    const Real by = static_cast<Real>(scale);
#pragma omp simd
    for (std::size_t m = 0; m < n; ++m) stored[m] *= by;
    scale = 1;
  }
  template <class Real>
  void write(Real* __restrict stored, Real* __restrict sum, std::size_t n) {
    finish_band(stored, sum, n);
    write(stored, n);
  }
};

/// How rays are stored before a segment and after it.
template <class Real>
struct SightInSegment {
  Real scale, seen;
  Real inverse_after, seen_after;

  SightInSegment(const StoredSight& before, const StoredSight& after)
      : scale(static_cast<Real>(before.scale)),
        seen(static_cast<Real>(before.seen)),
        inverse_after(static_cast<Real>(1 / after.scale)),
        seen_after(static_cast<Real>(after.seen)) {}
};

/// `count` <= lanes rays, going back from the plane, meet as many cells. The light of these cells is added to `sum`,
/// and the transmission decreases (docs/theory.md, Eq. 20). Light leaves through the end of the segment that is nearest
/// the plane.
/// @tparam in_air rays are stored as `how`, else as they are.
/// @param sent the cells' source; @param stored transmission of each ray, from the plane to here, weighted.
template <bool linear, bool in_air, class Real>
[[gnu::always_inline]] inline void meet_cells(const SegmentGeometry<Real>& g, int count, const CellView<Real>& cells,
                                              std::size_t cell, const Real* __restrict sent, Real* __restrict stored,
                                              Real* __restrict sum, const SightInSegment<Real>& how) {
  const Real* __restrict const sigma = cells.extinction + cell;
  const std::size_t first = linear ? cell : 0;
  const Real* __restrict const x = cells.gradient[0] + first;
  const Real* __restrict const y = cells.gradient[1] + first;
  const Real* __restrict const z = cells.gradient[2] + first;
  for_lanes<Real>(
      count, [=](int i, bool active) __attribute__((always_inline)) {
        const Crossing<Real> crossing(optical_path(sigma[i], g.length));
        Real emitted = crossing.phi.phi1;
        if constexpr (linear) emitted = crossing.emitted(g.at_exit(x[i], y[i], z[i]), g.at_entry(x[i], y[i], z[i]));
        const Real transmitted = in_air ? how.scale * stored[i] : stored[i];
        const Real met = active ? crossing.t * transmitted : Real(0);
        const Real after = transmitted - met * crossing.phi.phi1;  // absorption in the cell: Crossing::absorbed()
        if constexpr (in_air) {
          const Real stored_after = how.inverse_after * after;
          const Real light = how.seen * stored[i] + met * sent[i] * emitted - how.seen_after * stored_after;
          sum[i] += active ? light : Real(0);
          stored[i] = active ? stored_after : stored[i];
        } else {
          sum[i] += met * sent[i] * emitted;
          stored[i] = after;
        }
      });
}

/// Rays of one segment, going back from the plane, meet blocks of air: their light is added to `sum`.
template <bool linear, class Real>
class AirMeeting {
 public:
  AirMeeting(const AirSource<linear, Real>& source, Real* transmitted, Real* sum)
      : source_(source), transmitted_(transmitted), sum_(sum) {}

  void enter(std::size_t cell) { seen_ = source_.emission(cell, true); }
  [[gnu::always_inline]] void cross(std::size_t ray, int n) const {
    Real* __restrict const transmitted = transmitted_ + ray;
    Real* __restrict const sum = sum_ + ray;
    const Real seen = seen_;
    const Real absorbed = source_.absorbed();
    for_rays<Real>(
        n, [=](int i, bool active) __attribute__((always_inline)) {
          const Real here = active ? transmitted[i] : Real(0);
          sum[i] += seen * here;
          transmitted[i] -= absorbed * here;
        });
  }
  void leave() const {}

 private:
  AirSource<linear, Real> source_;
  Real* transmitted_;
  Real* sum_;
  Real seen_ = 0;  // light of the block per transmission
};

/// Rays, going back from the plane, meet a uniform level, or one with one block of air.
/// @param cells, sent of the level, and their source.
template <bool linear, class Real>
void meet_level_in_air(const PathPattern& pattern, int step, const ActiveRows& rows, const CellView<Real>& cells,
                       const Real* sent, Real* stored, Real* sum, StoredSight& how) {
  const int level = pattern.level(step);
  const std::size_t first_cell = rows.level_cell[level];
  const std::size_t block = rows.level_cell[level + 1] - 1;
  const std::span<const Chunk> chunks = rows.levels.of(level);
  for (std::uint32_t s = pattern.level_begin[step]; s < pattern.level_begin[step + 1]; ++s) {
    const Segment& segment = pattern.segments[s];
    if (segment.fraction <= 0) continue;
    const SegmentGeometry<Real> g(segment, pattern.chord_m[step]);
    const AirSource<linear, Real> air(g, cells.extinction[block - first_cell], cells, sent, first_cell);
    StoredSight after = how;
    after.cross_air(static_cast<double>(air.absorbed()), static_cast<double>(air.emission(block, true)));
    if (!chunks.empty()) {
      cross_chunks(chunks, wrapped(segment.shift_x, rows.nx), wrapped(segment.shift_y, rows.ny), rows.nx, rows.ny,
                   [&, in = SightInSegment<Real>(how, after)](std::size_t ray, std::size_t cell, int count) {
                     meet_cells<linear, true>(g, count, cells, cell - first_cell, sent + (cell - first_cell),
                                              stored + ray, sum + ray, in);
                   });
    }
    how = after;
  }
}

/// Rays leave the plane against the light's travel, along `pattern`; the light on their way, times `weight`, is added
/// to `gathered`.
/// @param work whose source has been started along `travel`.
template <class Real>
void march_back(const GatherScene<Real>& scene, const PathPattern& pattern, const std::vector<Band>& bands,
                const Direction& travel, Real weight, GatherWorkspace<Real>& work, Gathered<Real>& gathered) {
  const BoxGrid& box = scene.box;
  const ActiveRows& rows = scene.cells.rows;
  const std::size_t columns = box.columns();
  work.transmitted.assign(columns + lane_padding, weight);
  const std::vector<double> side =
      !box.periodic && scene.side_radiance ? scene.side_radiance(travel) : std::vector<double>{};

  const Real reference = static_cast<Real>(scene.reference);
  const CellView<Real> all_cells(scene.extinction(), {});
  Real* const through = work.transmitted.data();
  StoredSight how;
  for (std::size_t b = 0; b < bands.size(); ++b) {
    Real* const of_band = gathered.of_band[b].data();
    if (reference != 0) {
      how.write(through, columns);
      work.at_band = work.transmitted;
    }
    for (int step = bands[b].first_step; step < bands[b].last_step; ++step) {
      const int level = pattern.level(step);
      const std::size_t first_cell = rows.level_cell[level];
      if (first_cell == rows.level_cell[level + 1] && box.periodic) continue;
      const CellView<Real> cells = work.source.level(first_cell, rows.level_cell[level + 1] - first_cell);
      const Real* const sent = work.source.value().data();
      if (box.periodic && crosses_in_air(pattern, step, rows, all_cells)) {
        constexpr double least_scale = 1e-6;  // far from the range of float, even after the thickest level
        if (how.scale < least_scale) how.write(through, of_band, columns);
        for_source_of(cells, [&](auto linear) {
          meet_level_in_air<linear>(pattern, step, rows, cells, sent, through, of_band, how);
        });
        continue;
      }
      how.write(through, of_band, columns);
      const double chord = pattern.chord_m[step];
      const auto leave = [&](const Segment& segment, double at) {
        if (box.periodic) return;
        const int lower = pattern.upward ? level : level + 1;  // interface at which this step begins
        const int upper = pattern.upward ? level + 1 : level;
        const Real outside = side.empty() ? Real(0) : static_cast<Real>((1 - at) * side[lower] + at * side[upper]);
        for_rays_through_side(segment, box.nx, box.ny, [&](std::size_t m) {
          gathered.beyond[m] += through[m] * (outside - reference);
          of_band[m] += through[m] * reference;  // these are not absorbed in the band
          through[m] = 0;
        });
      };
      for_source_of(cells, [&](auto linear) {
        const auto begin = [&](const Segment& segment) {
          // Without the attribute compilers may call it for each chunk, which takes a third longer.
          return [ =, g = SegmentGeometry<Real>(segment, chord) ](std::size_t ray, std::size_t cell, int count)
              __attribute__((always_inline)) {
            meet_cells<linear, false>(g, count, cells, cell - first_cell, sent + (cell - first_cell), through + ray,
                                      of_band + ray, {{}, {}});
          };
        };
        const auto begin_air = [&](const Segment& segment) {
          const Real extinction = all_cells.extinction[rows.air[level].first_cell];
          const AirSource<linear, Real> air({segment, chord}, extinction, cells, sent, first_cell);
          return AirMeeting<linear, Real>(air, through, of_band);
        };
        cross_level(pattern, step, level, rows, begin, begin_air, leave);
      });
    }
    how.finish_band(through, of_band, columns);
    if (reference == 0) continue;
    how.write(through, columns);
    for (std::size_t m = 0; m < columns; ++m) of_band[m] -= reference * (work.at_band[m] - through[m]);
  }
  how.write(through, columns);
  // Beyond the last level: the sky for light that comes down, the lit surface for light that goes up.
  Real* __restrict const beyond = gathered.beyond.data();
  if (travel.z() < 0) {
    const Real sky = static_cast<Real>(scene.sky_radiance) - reference;
    for (std::size_t m = 0; m < columns; ++m) beyond[m] += through[m] * sky;
  } else {
    const Real* const ground = scene.ground->along(travel, work.ground);
    for_shifted_rows(pattern.shift_x(pattern.levels()), pattern.shift_y(pattern.levels()), box.nx, box.ny,
                     [&](std::size_t column, std::size_t ray, int n) {
                       for (int i = 0; i < n; ++i)
                         beyond[ray + i] += through[ray + i] * (ground[column + i] - reference);
                     });
  }
}

}  // namespace cloudbow
