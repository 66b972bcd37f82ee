// The fit of one function to the control points as a linear programme.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "cloudbow/sphere/control_points.hpp"

namespace cloudbow {

/// What is minimised besides the mean: the largest scaled residual h, nothing (h unbounded), or nothing with h given.
enum class LargestResidual { minimised, free, bounded };

/// Over X: minimise h + mean_weight / n * sum |r_i| / mean_scale_i, where r = interpolation X - value, subject to
/// |r_i| <= scale_i h, rows X = right, X >= lower.
struct FitProgramme {
  std::span<const Stencil> samples;  ///< interpolation, n of them
  Eigen::VectorXd value;             ///< n
  Eigen::VectorXd scale;             ///< n, positive
  Eigen::VectorXd mean_scale;        ///< n, positive; not looked at where mean_weight is 0
  double mean_weight = 20;           ///< 0: h alone
  LargestResidual largest = LargestResidual::minimised;
  double bound = 0;  ///< h where it is given
  Eigen::MatrixXd
      rows;  ///< entries that stand for 0 must be 0: rounding left there makes the solver return wrong prices
  Eigen::VectorXd right;
  std::optional<double> lower = 0;  ///< nothing: X has any sign
};

enum class Simplex { primal, dual };

/// X, or nothing where the solver reports anything but an optimum. The answer wants checking: an optimum reported may
/// be wrong.
std::optional<Eigen::VectorXd> solve(const FitProgramme& programme, Simplex algorithm);

}  // namespace cloudbow
