// Fits of a function on the sphere, known at sample directions, to its values at the control points. A is the
// interpolation (samples x control points), Y the samples' values, X the values at the control points.
// (Chatelier & Malgouyres, "A fast interpolation method to represent the BRDF in global illumination")
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "cloudbow/sphere/control_points.hpp"

namespace cloudbow {

/// Divisor of a residual: 1 (Eq. 5), |Y| (Eq. 6), sqrt |Y| (Eq. 7). |Y| below 1e-6 of its largest counts as that value,
/// because a residual divided by 0 could only be 0.
enum class ResidualScale { absolute, relative, square_root };

/// Linear functionals of X that are to have given values.
struct ExactRows {
  Eigen::MatrixXd matrix;  ///< one functional a row
  Eigen::VectorXd right;
};

/// Minimises h + mean_weight * mean(|r_i| / mean_scale_i) subject to |r_i| <= h scale_i, the rows and X >= lower.
struct ConstrainedFit {
  ExactRows rows;
  double lower = 0;
  Eigen::VectorXd scale;             ///< positive, one per sample
  Eigen::VectorXd mean_scale;        ///< positive, one per sample; not used if mean_weight is 0
  double mean_weight = 20;           ///< 0: h alone
  bool minimax = true;               ///< false: the mean alone, without h
  std::optional<double> bound = {};  ///< h is given: the mean alone is minimised, subject to |r_i| <= bound scale_i
};

/// Positions of the products of a sample's three weights in a sparse symmetric matrix over the control points. Its
/// lower triangle is stored. All programmes with the same samples share it.
struct NormalPattern {
  NormalPattern() = default;
  NormalPattern(std::span<const Stencil> samples, int points);

  Eigen::SparseMatrix<double> matrix;      ///< control points x control points, all entries 0
  std::vector<std::array<int, 6>> sample;  ///< positions of (0,0) (1,0) (2,0) (1,1) (2,1) (2,2) of each stencil
  std::vector<int> diagonal;               ///< positions
};

class SphereFit {
 public:
  /// @param samples directions whose values determine all control points (four times as many, spread evenly, do).
  /// @throws InputError if they do not.
  SphereFit(const ControlPoints& points, std::vector<Direction> samples);

  std::span<const Direction> samples() const { return sample_; }
  /// A X.
  Eigen::VectorXd interpolated(const Eigen::VectorXd& at_points) const;
  /// X = (A^T A)^-1 A^T Y.
  Eigen::VectorXd least_squares(const Eigen::VectorXd& value) const;
  /// The X of least h with |A X - Y| <= h scale (Eq. 5 to 7), any sign. Nothing if the solver finds no optimum.
  std::optional<Eigen::VectorXd> minimax(const Eigen::VectorXd& value, ResidualScale scale) const;
  /// Nothing if there is no solution, or none that passes the check (rows within 1e-6).
  /// @param linear_programmes counted up by the programmes solved
  std::optional<Eigen::VectorXd> constrained(const Eigen::VectorXd& value, ConstrainedFit fit,
                                             int& linear_programmes) const;

 private:
  int points_;
  std::vector<Direction> sample_;
  std::vector<Stencil> stencil_;
  NormalPattern pattern_;
  Eigen::LLT<Eigen::MatrixXd> normal_equations_;
};

/// The values that residuals are divided by.
Eigen::VectorXd residual_scale(const Eigen::VectorXd& value, ResidualScale scale);

/// Scales X so that the first row holds, then makes the smallest relative change that makes all rows hold:
/// X += |X| C^T lambda with (C diag|X| C^T) lambda = right - C X.
Eigen::VectorXd corrected(const ExactRows& rows, Eigen::VectorXd x);

}  // namespace cloudbow
