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

/// Calls fade(k, extinction, lost, n) for the voxels with matter, level by level from the top. k is their level, n
/// their number; `extinction` is delta-M scaled (1/m). `lost` is the power that the beam loses there, as a fraction of
/// the power incident on a column. It is their mean. Columns are independent here, which is accurate enough for a
/// choice.
/// @param problem with such light.
template <class Fade>
void follow_beam(const Problem& problem, const SolverOptions& options, const Fade& fade) {
  std::vector<double> forward_fraction;
  for (const PhaseFunction& phase : problem.phase)
    forward_fraction.push_back(delta_m(phase, options.fit.delta_m_order).forward_fraction);
  const OpticalGrid& grid = problem.grid;
  const std::vector<double> extinction = scaled_extinction<double>(grid, forward_fraction);
  const BoxGrid& box = grid.box;
  const double mu0 = fading_cosine(problem);
  std::vector<double> above(box.columns(), 0.);  // optical depth of each column down to here
  for (int k = box.nz() - 1; k >= 0;) {
    if (!box.is_uniform(k)) {
      grid.for_each_place_of(k, [&](std::size_t column, std::size_t c) {
        const double depth = extinction[c] * box.thickness_m(k);
        fade(k, extinction[c], -std::expm1(-depth / mu0) * std::exp(-above[column] / mu0), 1.);
        above[column] += depth;
      });
      --k;
      continue;
    }
    // Uniform levels dim the beam by the same share in all columns.
    double in = 0, through = 0;
    for (const double depth : above) in += std::exp(-depth / mu0) / static_cast<double>(box.columns());
    for (; k >= 0 && box.is_uniform(k); --k) {
      if (grid.air_of(k).count() == 0) continue;
      const std::size_t c = grid.air_of(k).first_cell;
      const double depth = extinction[c] * box.thickness_m(k);
      const double lost = -std::expm1(-depth / mu0) * in;
      fade(k, extinction[c], lost, static_cast<double>(box.columns()));
      in -= lost;
      through += depth;
    }
    for (double& depth : above) depth += through;
  }
}

}  // namespace cloudbow
