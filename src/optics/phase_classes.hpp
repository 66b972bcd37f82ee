// Few phase functions in place of many: droplets whose size varies from voxel to voxel, sets of tabulated functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cloudbow/optics/phase_function.hpp"

namespace cloudbow {

/// A mixture of two neighbouring classes: `lower` and the share of scattered light that follows `lower` + 1.
struct ClassMixture {
  std::size_t lower;
  double next_share;
};

/// Some of a family of phase functions, in the family's order; the others are mixtures of two neighbouring ones.
class PhaseClasses {
 public:
  /// Takes as few functions as keep estimated_error() <= tolerance, and of that number the best. Mixing changes the
  /// share of scattered light that goes from down to up or from up to down. The error of a class is that change, the
  /// largest over eight directions. It is at least 1/4 of the relative change of 1 - g. The reason is the effect on a
  /// deep layer, T(1 - T) <= 1/4 of that relative change. Errors are averaged over the scattering. Absorption and
  /// extinction are not touched.
  /// @param family in the order of one parameter, droplet size or asymmetry, that neighbours differ little; not empty
  /// @param weight scattering of each, >= 0; functions without are left out. With a sum of 0 all count the same.
  /// @param tolerance fraction of the incident light; 0 keeps every function that has weight
  PhaseClasses(std::span<const PhaseFunction> family, std::span<const double> weight, double tolerance);

  /// Members of the family, ascending.
  const std::vector<std::size_t>& members() const { return members_; }
  /// Fraction of the incident light, as said above.
  double estimated_error() const { return error_; }

  /// The classes that represent a mixture of `member` and, with `next_share` of the scattering, the member after it.
  /// Both must lie between the first and the last member with weight.
  ClassMixture mixture(std::size_t member, double next_share = 0) const;

 private:
  std::vector<std::size_t> members_;
  std::vector<double> position_;  ///< [member of the family] class + share of the next one
  double error_ = 0;
};

}  // namespace cloudbow
