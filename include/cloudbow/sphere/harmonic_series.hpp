// Functions on the sphere as sums of real spherical harmonics: project, query, scale, add, rotate. They are the
// reference for the accuracy of control points (docs/sphere.md). The free functions work on many functions at once:
// `coefficients` then holds K rows, one per harmonic, of N contiguous functions.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "cloudbow/sphere/ordinate_set.hpp"
#include "cloudbow/sphere/spherical_harmonics.hpp"

namespace cloudbow {

/// result[n] = sum_k basis[k] * coefficients[k][n]: function n in the direction whose harmonics `basis` holds.
/// Real is float or double.
template <class Real>
void query_harmonics(std::span<const double> basis, std::span<const Real> coefficients, std::span<Real> result);

/// The matrices that rotate harmonics: the rotated function takes in direction R v the value that the function had in
/// direction v. Built degree by degree from R itself (Ivanic & Ruedenberg 1996, J. Phys. Chem. 100, 6342, Eq. 8.1 and
/// Table 1, with the corrections of 1998, J. Phys. Chem. A 102, 9099).
class HarmonicRotation {
 public:
  HarmonicRotation(const Eigen::Matrix3d& rotation, int degree);

  int degree() const { return static_cast<int>(block_.size()) - 1; }
  /// Orthogonal, 2l+1 rows and columns, for m = -l to l.
  const Eigen::MatrixXd& block(int l) const { return block_[l]; }

  /// Rotates K rows of N functions. The two must not overlap.
  template <class Real>
  void apply(std::span<const Real> coefficients, std::span<Real> rotated) const;

 private:
  std::vector<Eigen::MatrixXd> block_;
};

class HarmonicSeries {
 public:
  /// @param coefficients harmonic_count(degree) numbers, by harmonic_index().
  HarmonicSeries(int degree, std::vector<double> coefficients);
  /// Projects f: coefficients are integrals of f Y_lm by the ordinates' quadrature. If it is exact to at least twice
  /// the degree, this is also the least-squares fit.
  HarmonicSeries(int degree, const OrdinateSet& quadrature, const std::function<double(const Direction&)>& f);

  int degree() const { return basis_.degree(); }
  std::span<const double> coefficients() const { return coefficients_; }

  double operator()(const Direction& direction) const;
  std::vector<double> operator()(std::span<const Direction> directions) const;

  HarmonicSeries& operator*=(double factor);
  /// @param other of the same degree.
  HarmonicSeries& operator+=(const HarmonicSeries& other);
  HarmonicSeries rotated(const HarmonicRotation& rotation) const;

 private:
  HarmonicBasis basis_;
  std::vector<double> coefficients_;
};

}  // namespace cloudbow
