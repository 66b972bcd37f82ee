// The direct beam on its way down, for the choice of parts of levels and columns.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "cloudbow/optics/delta_m.hpp"
#include "cloudbow/transport/options.hpp"
#include "cloudbow/transport/problem.hpp"
#include "transport/grid/cells.hpp"
#include "transport/system/transport_system.hpp"

namespace cloudbow {

/// Whether light comes from above that fades in the cells: that of the sun, or what thermal emission leaves out. Deep
/// in matter light is in equilibrium with it; the difference, which begins at its top, fades downwards.
inline bool has_fading_light(const Problem& problem) { return problem.sun || problem.grid.emits(); }

/// Vertical cosine of this light, 3/5 if it is diffuse.
inline double fading_cosine(const Problem& problem) { return problem.sun ? -problem.sun->travel.z() : .6; }

/// Calls fade(k, extinction, lost) for every voxel with matter, level by level. k is its level; `extinction` is delta-M
/// scaled (1/m). `lost` is the power that the beam loses there, as a fraction of the power incident on its column.
/// Columns are independent here, which is accurate enough for a choice. @param problem with such light.
template <class Fade>
void follow_beam(const Problem& problem, const SolverOptions& options, const Fade& fade) {
  std::vector<double> forward_fraction;
  for (const PhaseFunction& phase : problem.phase)
    forward_fraction.push_back(delta_m(phase, options.fit.delta_m_order).forward_fraction);
  const std::vector<double> extinction = scaled_extinction<double>(problem.grid, forward_fraction);
  const BoxGrid& box = problem.grid.box;
  // Optical depth of the column above each voxel, from the bottom up: what is above is known at the end.
  std::vector<double> above(box.columns(), 0.);
  problem.grid.for_each_place(
      [&](int k, std::size_t column, std::size_t c) { above[column] += extinction[c] * box.thickness_m(k); });
  const double mu0 = fading_cosine(problem);
  problem.grid.for_each_place([&](int k, std::size_t column, std::size_t c) {
    const double depth = extinction[c] * box.thickness_m(k);
    above[column] -= depth;
    const double in = std::exp(-std::max(above[column], 0.) / mu0);
    fade(k, extinction[c], -std::expm1(-depth / mu0) * in);
  });
}

}  // namespace cloudbow
