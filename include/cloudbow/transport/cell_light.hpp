// Light in the cells of a solve, from which another solve of the same problem starts.
#pragma once

#include <optional>
#include <vector>

#include "cloudbow/transport/solve_plan.hpp"

namespace cloudbow {

/// Filled by a solve (solver.hpp). Its contents are of no use to others.
struct CellLight {
  std::optional<SolvePlan> plan{};  ///< whose cells these are; none: there is no light
  std::vector<float> moments{};     ///< [9][cells] l <= 2 of all light with the direct beam, W m-2
  /// [8 octants * 3 axes][cells] of the multiply scattered source from face to face, relative to it; empty: none.
  std::vector<std::vector<float>> slopes{};
};

}  // namespace cloudbow
