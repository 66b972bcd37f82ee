// The fit of one function to the control points as a linear programme.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "cloudbow/sphere/control_points.hpp"

namespace cloudbow {

/// Second term of the objective, added to the mean: the largest scaled residual h, none (h unbounded), or none with h
/// given.
enum class LargestResidual { minimised, free, bounded };

/// Over X: minimise h + mean_weight / n * sum |r_i| / mean_scale_i with r = interpolation X - value. Constraints: |r_i|
/// <= scale_i h, rows X = right, X >= lower.
struct FitProgramme {
  std::span<const Stencil> samples;  ///< interpolation, n of them
  Eigen::VectorXd value;             ///< n
  Eigen::VectorXd scale;             ///< n, positive
  Eigen::VectorXd mean_scale;        ///< n, positive; not used if mean_weight is 0
  double mean_weight = 20;           ///< 0: h alone
  LargestResidual largest = LargestResidual::minimised;
  double bound = 0;  ///< h if it is given
  Eigen::MatrixXd
      rows;  ///< entries that represent 0 must be 0: rounding left there makes the solver return wrong prices
  Eigen::VectorXd right;
  std::optional<double> lower = 0;  ///< nothing: X has any sign
};

enum class Simplex { primal, dual };

/// X, or nothing if the solver reports anything but an optimum. The caller must check the answer: a reported optimum
/// may be wrong.
std::optional<Eigen::VectorXd> solve(const FitProgramme& programme, Simplex algorithm);

}  // namespace cloudbow
