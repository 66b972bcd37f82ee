// When threads are worth waking: results do not depend on it.
#pragma once

#include <algorithm>
#include <cstddef>

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Fewer cells are swept sooner than threads have met at their barriers.
inline constexpr std::size_t worth_threads = 5000;

/// One where there are few cells, else as many as are given.
inline int threads_for(std::size_t cells, int threads) { return cells < worth_threads ? 1 : threads; }

/// Of a solve, without its axes that are left out and with its levels cut.
inline int threads_for(const Problem& problem, const SolverOptions& options) {
  const std::size_t columns = problem.grid.box.columns();
  const std::size_t solved =
      options.actinic ? columns * static_cast<std::size_t>(problem.grid.box.nz()) : problem.grid.active_cells();
  return threads_for(std::max(solved, columns), options.threads);
}

}  // namespace cloudbow
