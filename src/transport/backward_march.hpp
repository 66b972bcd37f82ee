// One direction's light, marched backwards from a plane: what its cells send there, and what comes from beyond.
#pragma once

#include <algorithm>
#include <vector>

#include "cloudbow/transport/gather.hpp"

namespace cloudbow {

/// Levels, in marching order, whose light is booked together.
struct Band {
  int first_step;
  int last_step;      ///< exclusive
  double distance_m;  ///< of its middle from the plane
  bool empty;         ///< no active cell in it
};

template <class Real>
struct GatherWorkspace {
  LinearSource<Real> source;
  std::vector<Real> gathered, transmitted, ground;
};

/// Rays leave the plane against the light's travel, one a column, as `pattern` says. of_band[b] is what the cells of a
/// band that is not empty send, `beyond` what comes from beyond the last level or the sides; [columns] each.
template <class Real>
void march_back(const GatherScene<Real>& scene, const PathPattern& pattern, const std::vector<Band>& bands,
                const Direction& travel, GatherWorkspace<Real>& work, std::vector<std::vector<Real>>& of_band,
                std::vector<Real>& beyond) {
  const BoxGrid& box = scene.box;
  const ActiveRows& rows = scene.cells.rows;
  const std::size_t columns = box.columns();
  work.source.resize(scene.cells.size());
  scene.source.query(travel, work.source.value.data());
  work.source.make_gradient(scene.cells);
  work.gathered.assign(columns + lane_padding, Real(0));
  work.transmitted.assign(columns + lane_padding, Real(1));
  beyond.assign(columns, Real(0));
  const std::vector<double> side =
      !box.periodic && scene.side_radiance ? scene.side_radiance(travel) : std::vector<double>{};

  for (std::size_t b = 0; b < bands.size(); ++b) {
    for (int step = bands[b].first_step; step < bands[b].last_step; ++step) {
      const int level = pattern.level(step);
      const double chord = pattern.chord_m[step];
      const auto begin = [&](const Segment& segment) {
        return [&, g = SegmentGeometry<Real>(segment, chord)](std::size_t ray, std::size_t cell, int count) {
          Real* __restrict const gathered = work.gathered.data() + ray;
          Real* __restrict const transmitted = work.transmitted.data() + ray;
          const Real* __restrict const sigma = scene.cells.extinction.data() + cell;
          const Real* __restrict const s = work.source.value.data() + cell;
          const Real* __restrict const gx = work.source.gradient[0].data() + cell;
          const Real* __restrict const gy = work.source.gradient[1].data() + cell;
          const Real* __restrict const gz = work.source.gradient[2].data() + cell;
          for_lanes<Real>(count, [=](int i, bool active) {
            const Real t = std::min(sigma[i] * g.length, static_cast<Real>(largest_optical_path));
            const auto phi = exponential_functions(t);
            const Real near = s[i] * (1 + g.from_x * gx[i] + g.from_y * gy[i] + g.from_z * gz[i]);
            const Real far = s[i] * (1 + g.to_x * gx[i] + g.to_y * gy[i] + g.to_z * gz[i]);
            const Real seen = t * transmitted[i];
            const Real more = seen * (phi.phi2 * near + (phi.phi1 - phi.phi2) * far);
            gathered[i] = active ? gathered[i] + more : gathered[i];
            transmitted[i] = active ? transmitted[i] - seen * phi.phi1 : transmitted[i];
          });
        };
      };
      const auto leave = [&](const Segment& segment, double at) {
        if (box.periodic) return;
        const int lower = pattern.upward ? level : level + 1;  // interface where this step begins
        const int upper = pattern.upward ? level + 1 : level;
        const Real outside = side.empty() ? Real(0) : static_cast<Real>((1 - at) * side[lower] + at * side[upper]);
        for_rays_through_side(segment, box.nx, box.ny, [&](std::size_t m) {
          beyond[m] += work.transmitted[m] * outside;
          work.transmitted[m] = 0;
        });
      };
      cross_level(pattern, step, level, rows, begin, leave);
    }
    if (!bands[b].empty) {
      of_band[b].swap(work.gathered);
      work.gathered.assign(columns + lane_padding, Real(0));
    }
  }
  // Beyond the last level: the sky for light that comes down, the lit surface for light that goes up.
  const bool upward_light = travel.z() > 0;
  const Real* const ground = upward_light ? scene.ground->along(travel, work.ground) : nullptr;
  const int sx = wrapped(static_cast<int>(std::floor(pattern.x.back())), box.nx);
  const int sy = wrapped(static_cast<int>(std::floor(pattern.y.back())), box.ny);
  for (int r = 0; r < box.ny; ++r) {
    for (int m = 0; m < box.nx; ++m) {
      const std::size_t ray = static_cast<std::size_t>(r) * box.nx + m;
      const std::size_t hit = static_cast<std::size_t>((r + sy) % box.ny) * box.nx + (m + sx) % box.nx;
      beyond[ray] += work.transmitted[ray] * (upward_light ? ground[hit] : static_cast<Real>(scene.sky_radiance));
    }
  }
}

}  // namespace cloudbow
