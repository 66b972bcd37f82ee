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

/// Calls fade(k, extinction, lost) for every voxel with matter, level by level. k is its level; `extinction` is delta-M
/// scaled (1/m). `lost` is the power that the beam loses there, as a fraction of the power incident on its column.
/// Columns are independent here, which is accurate enough for a choice. @param problem with a sun.
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
  const double mu0 = -problem.sun->travel.z();
  problem.grid.for_each_place([&](int k, std::size_t column, std::size_t c) {
    const double depth = extinction[c] * box.thickness_m(k);
    above[column] -= depth;
    const double in = std::exp(-std::max(above[column], 0.) / mu0);
    fade(k, extinction[c], -std::expm1(-depth / mu0) * in);
  });
}

}  // namespace cloudbow
