// A phase function as a table over the scattering angle.
#pragma once

#include <span>
#include <vector>

namespace cloudbow {

/// A function given at ascending cosines, linear between.
struct PhaseTable {
  std::vector<double> mu;
  std::vector<double> value;

  double operator()(double x) const;
  /// Over the sphere.
  double mean() const;
  /// (1/2) int P P_l dmu for l below `count`, by Gauss-Legendre on each segment. Nodes suffice for the oscillations of
  /// P_l in it.
  std::vector<double> moments(int count) const;
};

/// Values at ascending scattering angles [deg] from 0 to 180. @throws InputError for negative values, values that are 0
/// everywhere, angles that do not ascend or do not cover 0 to 180.
PhaseTable make_phase_table(std::span<const double> angle_deg, std::span<const double> value);

}  // namespace cloudbow
