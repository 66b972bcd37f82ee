// One direction's light, marched backwards from a plane: what its cells send there, and what comes from beyond.
#pragma once

#include <algorithm>
#include <vector>

#include "transport/observers/gather.hpp"

namespace cloudbow {

/// Levels, in marching order, whose light is booked together.
struct Band {
  int first_step;
  int last_step;      ///< exclusive
  double distance_m;  ///< of its middle from the plane
  bool empty;         ///< no active cell in it
};

/// What is added up for rays that leave a plane, one a column.
template <class Real>
struct Gathered {
  std::vector<std::vector<Real>> of_band;  ///< [bands][columns + lane_padding] what the cells send
  std::vector<Real> beyond;                ///< [columns] what comes from beyond the last level or the sides

  void clear(std::size_t bands, std::size_t columns) {
    of_band.resize(bands);
    for (auto& band : of_band) band.assign(columns + lane_padding, Real(0));
    beyond.assign(columns, Real(0));
  }
};

template <class Real>
struct GatherWorkspace {
  std::vector<Real> source, transmitted, ground;
};

/// Rays leave the plane against the light's travel, as `pattern` says; what they meet, times `weight`, is added to
/// `gathered`.
/// @param source along `travel`.
template <class Real>
void march_back(const GatherScene<Real>& scene, const PathPattern& pattern, const std::vector<Band>& bands,
                const Direction& travel, const SourceAlong<Real>& source, Real weight, const CellView<Real>& cells,
                GatherWorkspace<Real>& work, Gathered<Real>& gathered) {
  const BoxGrid& box = scene.box;
  const ActiveRows& rows = scene.cells.rows;
  const std::size_t columns = box.columns();
  work.source.resize(rows.largest_level() + lane_padding);
  work.transmitted.assign(columns + lane_padding, weight);
  const std::vector<double> side =
      !box.periodic && scene.side_radiance ? scene.side_radiance(travel) : std::vector<double>{};

  const Real* const sent = work.source.data();
  Real* const through = work.transmitted.data();
  for (std::size_t b = 0; b < bands.size(); ++b) {
    Real* const of_band = gathered.of_band[b].data();
    for (int step = bands[b].first_step; step < bands[b].last_step; ++step) {
      const int level = pattern.level(step);
      const std::size_t first_cell = rows.level_cell[level];
      source.fill(first_cell, rows.level_cell[level + 1] - first_cell, work.source.data());
      const double chord = pattern.chord_m[step];
      const auto begin = [&](const Segment& segment) {
        return [=, g = SegmentGeometry<Real>(segment, chord)](std::size_t ray, std::size_t cell, int count) {
          Real* __restrict const sum = of_band + ray;
          Real* __restrict const transmitted = through + ray;
          const Real* __restrict const s = sent + (cell - first_cell);
          const Real* __restrict const sigma = cells.extinction + cell;
          const Real* __restrict const gx = cells.gradient[0] + cell;
          const Real* __restrict const gy = cells.gradient[1] + cell;
          const Real* __restrict const gz = cells.gradient[2] + cell;
          for_lanes<Real>(count, [=](int i, bool active) {
            const Real t = std::min(sigma[i] * g.length, static_cast<Real>(largest_optical_path));
            const auto phi = exponential_functions(t);
            const Real near = 1 + g.from_x * gx[i] + g.from_y * gy[i] + g.from_z * gz[i];
            const Real far = 1 + g.to_x * gx[i] + g.to_y * gy[i] + g.to_z * gz[i];
            const Real seen = active ? t * transmitted[i] : Real(0);
            sum[i] += seen * s[i] * (phi.phi2 * near + (phi.phi1 - phi.phi2) * far);
            transmitted[i] -= seen * phi.phi1;
          });
        };
      };
      const auto leave = [&](const Segment& segment, double at) {
        if (box.periodic) return;
        const int lower = pattern.upward ? level : level + 1;  // interface where this step begins
        const int upper = pattern.upward ? level + 1 : level;
        const Real outside = side.empty() ? Real(0) : static_cast<Real>((1 - at) * side[lower] + at * side[upper]);
        for_rays_through_side(segment, box.nx, box.ny, [&](std::size_t m) {
          gathered.beyond[m] += through[m] * outside;
          through[m] = 0;
        });
      };
      cross_level(pattern, step, level, rows, begin, leave);
    }
  }
  // Beyond the last level: the sky for light that comes down, the lit surface for light that goes up.
  Real* __restrict const beyond = gathered.beyond.data();
  if (travel.z() < 0) {
    const Real sky = static_cast<Real>(scene.sky_radiance);
    for (std::size_t m = 0; m < columns; ++m) beyond[m] += through[m] * sky;
  } else {
    const Real* const ground = scene.ground->along(travel, work.ground);
    for_shifted_rows(pattern.shift_x(pattern.levels()), pattern.shift_y(pattern.levels()), box.nx, box.ny,
                     [&](std::size_t column, std::size_t ray, int n) {
                       for (int i = 0; i < n; ++i) beyond[ray + i] += through[ray + i] * ground[column + i];
                     });
  }
}

}  // namespace cloudbow
