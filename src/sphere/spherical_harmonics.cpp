#include "cloudbow/sphere/spherical_harmonics.hpp"

#include <cmath>
#include <complex>
#include <numbers>

namespace cloudbow {

Eigen::MatrixXd real_spherical_harmonics(std::span<const Direction> directions, int degree) {
  Eigen::MatrixXd harmonics((degree + 1) * (degree + 1), directions.size());
  for (Eigen::Index n = 0; n < harmonics.cols(); ++n) {
    const Direction& v = directions[n];
    double sectoral = std::sqrt(0.25 / std::numbers::pi);  // normalised P_mm without its factor sin^m
    std::complex<double> azimuthal = 1;                    // (sin e^{i azimuth})^m
    for (int m = 0; m <= degree; ++m) {
      if (m > 0) {
        sectoral *= std::sqrt((2 * m + 1) / (2.0 * m));
        azimuthal *= std::complex(v.x(), v.y());
      }
      double before = 0, value = sectoral, factor_before = 0;
      for (int l = m; l <= degree; ++l) {
        if (l > m) {
          // Normalised three-term recurrence in l at fixed m.
          const double factor = std::sqrt((4.0 * l * l - 1) / (1.0 * l * l - 1.0 * m * m));
          const double next = factor * (v.z() * value - (factor_before > 0 ? before / factor_before : 0));
          before = value;
          value = next;
          factor_before = factor;
        }
        if (m == 0) {
          harmonics(harmonic_index(l, 0), n) = value;
        } else {
          harmonics(harmonic_index(l, m), n) = std::numbers::sqrt2 * value * azimuthal.real();
          harmonics(harmonic_index(l, -m), n) = std::numbers::sqrt2 * value * azimuthal.imag();
        }
      }
    }
  }
  return harmonics;
}

}  // namespace cloudbow
