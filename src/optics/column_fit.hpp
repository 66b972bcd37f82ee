// One column of the scattering table: the phase function about one direction of arrival, fitted to the control points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "cloudbow/optics/phase_function.hpp"
#include "cloudbow/optics/scattering_table.hpp"
#include "cloudbow/optics/sphere_fit.hpp"
#include "cloudbow/sphere/control_points.hpp"
#include "cloudbow/sphere/ordinate_set.hpp"

namespace cloudbow {

struct FittedColumn {
  Eigen::VectorXd value;  ///< X, at the control points
  int linear_programmes = 0;
  bool fell_back = false;
  int exact_degree = -1;  ///< moments l <= this were prescribed in the end
  double max_error = 0;   ///< worst |fit - P| / max |P| at the samples
};

class ColumnFit {
 public:
  /// @param ordinates directions and weights of the quadrature under which moments are held
  ColumnFit(const ControlPoints& points, const OrdinateSet& ordinates, const FitOptions& options);

  /// @param travel direction in which the arriving light travels.
  /// @param half_range_rows rows int_up mu^k P, k < half_range_rows, in addition to the moments.
  FittedColumn fit(const PhaseFunction& phase, const Direction& travel, int half_range_rows) const;
  /// As the linear programme of fit(), but returns the solution of least mean error without residuals above the bound.
  /// If the rows leave none, the bound is the least that they allow.
  FittedColumn fit_bounded(const PhaseFunction& phase, const Direction& travel, double bound) const;
  /// Brings the moments from the 1e-9 of the linear programme to rounding.
  void polish(FittedColumn& column, const PhaseFunction& phase, const Direction& travel) const;

  const SphereFit& sphere_fit() const { return fit_; }
  Eigen::VectorXd sampled(const PhaseFunction& phase, const Direction& travel) const;
  Eigen::VectorXd at_points(const PhaseFunction& phase, const Direction& travel) const;
  /// chi_l about the direction of a function given at the control points, l <= options.exact_moments.
  double moment(const Eigen::VectorXd& value, const Direction& travel, int l) const;

 private:
  /// Moments l <= degree and half-range integrals of P about the direction, as the ordinates' quadrature sees them.
  ExactRows exact_rows(const PhaseFunction& phase, const Direction& travel, int degree, int half_range_rows) const;
  /// `attempt` takes rows and returns X or nothing.
  template <class Attempt>
  void fit_with_fewer_rows(FittedColumn& column, const PhaseFunction& phase, const Direction& travel,
                           int half_range_rows, const Attempt& attempt) const;
  ConstrainedFit objective(const PhaseFunction& phase, const Eigen::VectorXd& value) const;
  void finish(FittedColumn& column, const PhaseFunction& phase, const Direction& travel) const;

  const ControlPoints& points_;
  FitOptions options_;
  SphereFit fit_;
  Eigen::MatrixXd moment_rows_;      // harmonics up to options_.exact_moments
  Eigen::MatrixXd half_range_rows_;  // options_.beam_half_range_rows
};

}  // namespace cloudbow
