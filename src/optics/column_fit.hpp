// One column of the scattering table: the phase function about one direction of arrival, fitted to the control points.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "cloudbow/optics/phase_function.hpp"
#include "cloudbow/optics/scattering_table.hpp"
#include "cloudbow/sphere/control_points.hpp"
#include "cloudbow/sphere/ordinate_set.hpp"

namespace cloudbow {

struct ExactRows {
  Eigen::MatrixXd matrix;  ///< one functional of X a row
  Eigen::VectorXd right;
};

struct FittedColumn {
  Eigen::VectorXd value;  ///< X, at the control points
  int linear_programmes = 0;
  bool fell_back = false;
  double max_error = 0;  ///< worst |fit - P| / max |P| at the samples
};

class ColumnFit {
 public:
  ColumnFit(const ControlPoints& points, const OrdinateSet& ordinates, const FitOptions& options);

  /// @param travel direction in which the arriving light travels
  /// @param half_range_rows rows int_up mu^k P, k < half_range_rows, besides the moments
  FittedColumn fit(const PhaseFunction& phase, const Direction& travel, int half_range_rows) const;

 private:
  /// Moments l <= degree and half-range integrals of P about the direction, as the ordinates' quadrature sees them.
  ExactRows exact_rows(const PhaseFunction& phase, const Direction& travel, int degree, int half_range_rows) const;
  void fit_by_programme(FittedColumn& column, const PhaseFunction& phase, const Direction& travel,
                        int half_range_rows) const;
  Eigen::VectorXd least_squares(const Eigen::VectorXd& value) const;
  Eigen::VectorXd sampled(const PhaseFunction& phase, const Direction& travel) const;
  Eigen::VectorXd at_points(const PhaseFunction& phase, const Direction& travel) const;
  Eigen::VectorXd interpolated(const Eigen::VectorXd& column) const;

  const ControlPoints& points_;
  FitOptions options_;
  std::vector<Direction> sample_;
  std::vector<Stencil> sample_stencil_;
  Eigen::MatrixXd moment_rows_;      // harmonics up to options_.exact_moments
  Eigen::MatrixXd half_range_rows_;  // options_.beam_half_range_rows
  Eigen::LLT<Eigen::MatrixXd> normal_equations_;
};

}  // namespace cloudbow
