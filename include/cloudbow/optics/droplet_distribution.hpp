// Size distributions of droplets, with parameters effective radius r_e = <r^3>/<r^2> and effective variance v = <(r -
// r_e)^2 r^2> / (r_e^2 <r^2>). Source: Hansen & Travis 1974, Space Sci. Rev. 16, 527, Eqs. 2.53, 2.54.
#pragma once

#include <string>
#include <vector>

namespace cloudbow {

enum class DistributionKind { gamma, lognormal };

/// gamma:     n(r) ~ r^((1 - 3v)/v) exp(-r / (r_e v)), 0 < v < 1/2. Deirmendjian's C.1 is r_e = 6 um, v = 1/9.
/// lognormal: n(r) ~ 1/r exp(-ln^2(r/r_g) / (2 s^2)), s^2 = ln(1 + v), r_g = r_e (1 + v)^(-5/2).
/// (Hansen & Travis 1974, Eqs. 2.56 to 2.60.)
class DropletDistribution {
 public:
  /// @throws InputError unless effective_radius_um > 0 and 1e-4 <= v <= 0.45 (gamma) or 1e-4 <= v <= 2 (lognormal).
  DropletDistribution(DistributionKind kind, double effective_radius_um, double effective_variance);

  /// ln n(r) but for a constant.
  double log_density(double radius_um) const;
  /// Radius at which r^power n(r) per ln r is largest [um].
  double mode(double power) const;
  /// Radii [um] outside which scattering and water are negligible, to 1e-8 of a maximum. Below the first r^3 n(r) per
  /// ln r is smaller than that part of its maximum. Above the second r^5 n(r) per ln r (the forward peak's) is.
  double smallest_radius_um() const;
  double largest_radius_um() const;

  double effective_radius_um() const { return effective_radius_um_; }
  double effective_variance() const { return effective_variance_; }

 private:
  double fallen_radius(double power, double from_um, double towards_factor) const;

  DistributionKind kind_;
  double effective_radius_um_;
  double effective_variance_;
  double log_geometric_radius_;  // lognormal
  double log_width_squared_;     // lognormal
};

std::string distribution_name(DistributionKind kind);

}  // namespace cloudbow
