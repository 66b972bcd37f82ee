// Phase functions, normalised to mean 1 over the sphere (integral 4 pi), with Legendre moments chi_l: P(mu) = sum
// (2l+1) chi_l P_l(mu).
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace cloudbow {

class PhaseFunction {
 public:
  static PhaseFunction isotropic();
  static PhaseFunction rayleigh();  ///< 3/4 (1 + mu^2)
  /// @param g asymmetry parameter, -1 < g < 1, else InputError. (Henyey & Greenstein 1941)
  static PhaseFunction henyey_greenstein(double g);
  /// forward_weight * HG(g_forward) + (1 - forward_weight) * HG(g_backward), 0 <= forward_weight <= 1, else InputError.
  static PhaseFunction double_henyey_greenstein(double g_forward, double g_backward, double forward_weight);
  /// @param moments chi_0 = 1, chi_1, ...; |chi_l| <= 1, without the factor 2l+1. InputError otherwise.
  static PhaseFunction legendre(std::vector<double> moments);
  /// Values on ascending scattering angles [deg] covering 0..180, linear in the cosine between; normalised to mean 1.
  /// InputError for negative values, angles that do not ascend or do not cover 0 to 180. Moments are kept up to degree
  /// 1023.
  static PhaseFunction table(std::span<const double> angle_deg, std::span<const double> value);

  /// P at a cosine of the scattering angle, clamped to [-1, 1].
  double operator()(double cos_angle) const;
  /// chi_l for any l >= 0: closed form for Henyey-Greenstein, otherwise 0 beyond the stored ones.
  double moment(int l) const;
  double asymmetry_parameter() const { return moment(1); }
  /// The stored moments, chi_0 first. Henyey-Greenstein keeps those above 1e-17 (at most 65536).
  std::span<const double> moments() const { return moments_; }
  /// True if P = 1 everywhere.
  bool is_isotropic() const;
  /// Text that identifies the function completely: the key of caches and of equality.
  const std::string& key() const { return key_; }

 private:
  PhaseFunction() = default;
  std::vector<double> moments_;
  std::function<double(double)> exact_;       // empty: the Legendre sum
  std::function<double(int)> closed_moment_;  // empty: moments_ are all there is
  std::string key_;
};

}  // namespace cloudbow
