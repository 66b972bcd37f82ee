// Judges from the sizes of its steps whether an iteration still comes closer to its solution.
#pragma once

#include <span>

namespace cloudbow {

/// A pure function of the steps, so that a restored iteration judges as one that was never stopped.
struct StepWatch {
  bool restarted = false;    ///< in this sweep or before
  bool restart_now = false;  ///< after this sweep, for the first time
  bool diverges = false;     ///< the restart was made at large or grown steps
  bool stuck = false;        ///< no longer comes closer, and a restart did not or cannot help
  double least = 0;          ///< smallest step since the restart, or of all

  /// Steps grow, or fall by less than a tenth in `patience` sweeps: the first time the iteration should restart. The
  /// second time it is stuck. Steps as small as rounding are not worth a restart.
  /// @param steps relative size of each step so far, >= 0.
  /// @param rounding steps below this may be due to rounding alone.
  /// @param changed index of the first of `change` steps in which the problem changed; negative: it did not. These
  /// steps are not judged. Those before them are no measure of those after.
  static StepWatch of(std::span<const double> steps, double rounding, int changed = -1, int change = 0);

  static constexpr int patience = 8;
  static constexpr double large = .01;  ///< steps beyond it are due to divergence: slow convergence has smaller ones
};

}  // namespace cloudbow
