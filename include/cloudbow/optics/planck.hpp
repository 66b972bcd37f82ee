// Planck's law: radiance of a black body at one wavelength or integrated over a band, and its inverse.
#pragma once

#include <array>

namespace cloudbow {

/// Radiance of a black body in one spectral interval.
class PlanckFunction {
 public:
  /// At one wavelength: W m-2 sr-1 um-1. @param wavelength_um > 0. @throws InputError if it is out of .1 to 1e4.
  static PlanckFunction at(double wavelength_um);
  /// Integrated over a band: W m-2 sr-1. @param band_um its ends, ascending, > 0; the upper end may be infinite.
  /// @throws InputError for any other ends.
  static PlanckFunction over(std::array<double, 2> band_um);

  /// @param temperature_k >= 0; at 0 K it is 0.
  double radiance(double temperature_k) const;
  double operator()(double temperature_k) const { return radiance(temperature_k); }
  /// Temperature of a black body with this radiance, K. @param radiance >= 0; of 0 it is 0 K, never NaN. Negative
  /// radiances, which rounding can leave, count as 0.
  double brightness_temperature(double radiance) const;

 private:
  double wavelength_um_ = 0;  // 0: a band
  std::array<double, 2> band_um_{};
};

}  // namespace cloudbow
