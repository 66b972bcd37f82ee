// Real spherical harmonics, orthonormal over the sphere, without the Condon-Shortley phase.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "cloudbow/sphere/direction.hpp"

namespace cloudbow {

/// Row of Y_lm, -l <= m <= l, in real_spherical_harmonics().
constexpr int harmonic_index(int l, int m) { return l * (l + 1) + m; }

/// Number of harmonics up to a degree.
constexpr int harmonic_count(int degree) { return (degree + 1) * (degree + 1); }

/// Y_lm of all degrees l <= degree, one direction at a time, with the recurrence's factors worked out beforehand.
/// Polynomials in x, y, z: the poles are no special case.
class HarmonicBasis {
 public:
  explicit HarmonicBasis(int degree);

  int degree() const { return degree_; }
  /// @param harmonics harmonic_count(degree) numbers: Y_00 = 1/sqrt(4 pi); m > 0 goes with cos(m azimuth), m < 0 with
  /// sin(|m| azimuth).
  void evaluate(const Direction& direction, std::span<double> harmonics) const;

 private:
  int degree_;
  std::vector<double> sectoral_;                  // Y_mm without its azimuthal part and sin^m
  std::vector<double> factor_, previous_factor_;  // of the recurrence in l, by harmonic_index(l, m)
};

/// Y_lm of many directions: (degree+1)^2 rows, one column a direction.
Eigen::MatrixXd real_spherical_harmonics(std::span<const Direction> directions, int degree);

}  // namespace cloudbow
