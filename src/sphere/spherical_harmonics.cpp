#include "cloudbow/sphere/spherical_harmonics.hpp"

#include <cassert>
#include <cmath>
#include <complex>
#include <numbers>

namespace cloudbow {

HarmonicBasis::HarmonicBasis(int degree)
    : degree_(degree), factor_(harmonic_count(degree)), previous_factor_(harmonic_count(degree)) {
  double sectoral = std::sqrt(0.25 / std::numbers::pi);
  for (int m = 0; m <= degree; ++m) {
    if (m > 0) sectoral *= std::sqrt((2 * m + 1) / (2.0 * m));
    sectoral_.push_back(m > 0 ? std::numbers::sqrt2 * sectoral : sectoral);
    double before = 0;
    for (int l = m + 1; l <= degree; ++l) {
      const double factor = std::sqrt((4.0 * l * l - 1) / (1.0 * l * l - 1.0 * m * m));
      factor_[harmonic_index(l, m)] = factor;
      previous_factor_[harmonic_index(l, m)] = before > 0 ? factor / before : 0;
      before = factor;
    }
  }
}

void HarmonicBasis::evaluate(const Direction& direction, std::span<double> harmonics) const {
  assert(static_cast<int>(harmonics.size()) == harmonic_count(degree_));
  std::complex<double> azimuthal = 1;  // (sin e^{i azimuth})^m
  for (int m = 0; m <= degree_; ++m) {
    double before = 0, value = sectoral_[m];
    for (int l = m; l <= degree_; ++l) {
      if (l > m) {
        // Normalised three-term recurrence in l at fixed m.
        const int at = harmonic_index(l, m);
        const double next = factor_[at] * direction.z() * value - previous_factor_[at] * before;
        before = value;
        value = next;
      }
      harmonics[harmonic_index(l, m)] = value * azimuthal.real();
      if (m > 0) harmonics[harmonic_index(l, -m)] = value * azimuthal.imag();
    }
    // Written out: the product of std::complex also looks for infinities.
    azimuthal = {azimuthal.real() * direction.x() - azimuthal.imag() * direction.y(),
                 azimuthal.real() * direction.y() + azimuthal.imag() * direction.x()};
  }
}

Eigen::MatrixXd real_spherical_harmonics(std::span<const Direction> directions, int degree) {
  const HarmonicBasis basis(degree);
  Eigen::MatrixXd harmonics(harmonic_count(degree), directions.size());
  for (Eigen::Index n = 0; n < harmonics.cols(); ++n) {
    basis.evaluate(directions[n], {harmonics.col(n).data(), static_cast<std::size_t>(harmonics.rows())});
  }
  return harmonics;
}

}  // namespace cloudbow
