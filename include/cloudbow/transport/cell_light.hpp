// Light in the cells of a solve, from which another solve of the same problem starts.
#pragma once

#include <optional>
#include <vector>

#include "cloudbow/transport/solve_plan.hpp"

namespace cloudbow {

/// Filled by a solve (solver.hpp). Its contents are of no use to others.
struct CellLight {
  std::optional<SolvePlan> plan{};  ///< whose cells these are; none: there is no light
  std::vector<float> moments{};     ///< l <= 2 of all light, with the direct beam, moment by moment
  /// Of the multiply scattered source, relative to it, octant by octant along x, y, z; empty: none.
  std::vector<std::vector<float>> slopes{};
};

}  // namespace cloudbow
