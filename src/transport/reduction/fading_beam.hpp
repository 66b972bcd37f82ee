// The direct beam on its way down, for the choice of parts of levels and columns.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "cloudbow/optics/delta_m.hpp"
#include "cloudbow/transport/options.hpp"
#include "cloudbow/transport/problem.hpp"
#include "transport/grid/cells.hpp"
#include "transport/system/transport_system.hpp"

namespace cloudbow {

/// Calls fade(k, extinction, lost) for every cell, from the top down. k is its level; `extinction` is delta-M scaled
/// (1/m). `lost` is the power that the beam loses there, as a fraction of the power incident on its column. Columns are
/// independent here, which is accurate enough for a choice. @param problem with a sun.
template <class Fade>
void follow_beam(const Problem& problem, const SolverOptions& options, const Fade& fade) {
  std::vector<double> forward_fraction;
  for (const PhaseFunction& phase : problem.phase)
    forward_fraction.push_back(delta_m(phase, options.fit.delta_m_order).forward_fraction);
  const std::vector<double> extinction = scaled_extinction<double>(problem.grid, forward_fraction);
  const BoxGrid& box = problem.grid.box;
  const std::vector<std::uint32_t> dense = dense_indices(problem.grid);
  std::vector<double> beam(box.columns(), 1.);
  for (int k = box.nz() - 1; k >= 0; --k) {
    const double path = box.thickness_m(k) / -problem.sun->travel.z();
    for (std::size_t c = problem.grid.first_cell(k); c < problem.grid.first_cell(k + 1); ++c) {
      double& in = beam[dense[c] % beam.size()];
      const double lost = -std::expm1(-extinction[c] * path) * in;
      in -= lost;
      fade(k, extinction[c], lost);
    }
  }
}

}  // namespace cloudbow
