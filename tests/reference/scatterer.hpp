// Phase functions of the Monte Carlo reference, and draws from them.
#pragma once

#include <span>
#include <vector>

namespace cloudbow::reference {

/// A phase function with mean 1 over the sphere, and draws from it.
class Scatterer {
 public:
  static Scatterer isotropic();
  static Scatterer rayleigh();                   ///< 3/4 (1 + mu^2)
  static Scatterer henyey_greenstein(double g);  ///< -1 < g < 1
  /// @param angle_deg scattering angles, ascending from 0 to 180
  /// @param value >= 0 at them, any factor; linear in the cosine between
  static Scatterer table(std::span<const double> angle_deg, std::span<const double> value);

  double operator()(double cos_angle) const;
  /// The cosine of the scattering angle below which a share `uniform` (0 to 1) of the light goes: the inverse of the
  /// cumulative distribution, exact for every kind.
  double cosine_at(double uniform) const;

 private:
  enum class Kind { isotropic, rayleigh, henyey_greenstein, table };
  Kind kind_ = Kind::isotropic;
  double g_ = 0;
  std::vector<double> cosine_, value_, cumulative_;  // of a table, cosines ascending
};

}  // namespace cloudbow::reference
