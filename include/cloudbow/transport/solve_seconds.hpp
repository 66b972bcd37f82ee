// Predicted time of a solve, phase by phase.
#pragma once

#include "cloudbow/transport/solve_plan.hpp"

namespace cloudbow {

/// Wall seconds on the machine on which the prediction was measured, by the plan's threads. Tables of phase functions
/// are taken to be in the cache.
struct SolveSeconds {
  double before_sweeps = 0;  ///< direct beams; all of a solve without sweeps
  double sweep = 0;          ///< of one, with its scattering and acceleration
  double sweeps = 0;         ///< their number
  double after_sweeps = 0;   ///< final gather, images

  double total() const { return before_sweeps + sweeps * sweep + after_sweeps; }
};

SolveSeconds predict_phases(const SolvePlan& plan);

}  // namespace cloudbow
