// The fit of one function to the control points as a linear programme.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "cloudbow/sphere/control_points.hpp"

namespace cloudbow {

/// Over X: minimise h + mean_weight / n * sum |r_i| / scale_i, where r = interpolation X - value, subject to |r_i| <=
/// scale_i h, rows X = right, X >= lower.
struct FitProgramme {
  std::span<const Stencil> samples;  ///< interpolation, n of them
  Eigen::VectorXd value;             ///< n
  Eigen::VectorXd scale;             ///< n, positive
  double mean_weight = 20;
  bool minimax = true;  ///< false: the mean alone, without h
  Eigen::MatrixXd
      rows;  ///< entries that stand for 0 must be 0: rounding left there makes the solver return wrong prices
  Eigen::VectorXd right;
  double lower = 0;
};

enum class Simplex { primal, dual };

/// X, or nothing where the solver reports anything but an optimum. The answer wants checking: an optimum reported may
/// be wrong.
std::optional<Eigen::VectorXd> solve(const FitProgramme& programme, Simplex algorithm);

}  // namespace cloudbow
