// Bidirectional reflectance of surfaces, f = reflected radiance per irradiance [1/sr], in the frame whose z axis is the
// surface's normal. Light is given by its direction of travel: arriving z < 0, leaving z > 0.
#pragma once

#include <functional>
#include <string>

#include "cloudbow/sphere/direction.hpp"

namespace cloudbow {

class SurfaceBrdf {
 public:
  /// f = albedo / pi, 0 <= albedo <= 1, else InputError.
  static SurfaceBrdf lambertian(double albedo);
  /// Rahman, Pinty & Verstraete 1993: f = rho0/pi [mu_i mu_o (mu_i + mu_o)]^(k-1) F(theta) [1 + (1 - rho_c)/(1 + G)].
  /// theta < 0 scatters back. InputError unless rho0 >= 0, k > 0, |theta| < 1, rho_c >= 0.
  static SurfaceBrdf rpv(double rho0, double k, double theta, double rho_c);
  /// Ross-thick and Li-sparse-reciprocal kernels, h/b = 2, b/r = 1 (Lucht, Schaaf & Strahler 2000). If the kernels sum
  /// to a negative value, f = 0. InputError for weights that are not finite or f_iso < 0.
  static SurfaceBrdf ross_li(double f_iso, double f_vol, double f_geo);
  /// Wind-ruffled water: slopes of variance .003 + .00512 W (Cox & Munk 1954), Fresnel's reflection of unpolarised
  /// light, shadowing of Smith 1967. Foam and light from under the surface are left out. InputError unless 0 <=
  /// wind_speed <= 50 and refractive_index > 1.
  static SurfaceBrdf cox_munk(double wind_speed_m_s, double refractive_index);

  /// Directions nearer the surface's plane than 1.1 degrees (|z| < .02) are taken there: the formulas diverge.
  double operator()(const Direction& arriving, const Direction& leaving) const;
  /// Directional-hemispherical albedo: integral of f mu_o over all leaving directions, for light arriving at the cosine
  /// mu (0 < mu <= 1) to the normal. By quadrature, to about 1e-4; may exceed 1 if a fitted model is evaluated beyond
  /// its range.
  double directional_albedo(double mu) const;
  bool is_lambertian() const { return lambertian_; }
  const std::string& key() const { return key_; }

 private:
  std::function<double(const Direction&, const Direction&)> function_;
  std::string key_;
  bool lambertian_ = false;
};

}  // namespace cloudbow
