#include "cloudbow/optics/mie_sphere.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace cloudbow {
namespace {

using Complex = std::complex<double>;

/// Ratios R_n = psi_n(z) / psi_{n-1}(z), n = 1 .. count at index n - 1, by downward recurrence from an order with
/// negligible psi: always stable, because psi is the solution that falls off with n. From R_n follows the logarithmic
/// derivative, D_n = (n+1)/z - R_{n+1}.
template <class Number>
std::vector<Number> riccati_bessel_ratios(Number z, int count) {
  // Behind the turning point n = |z| psi falls against the other solution as exp(-4/3 s^(3/2)), s = (n - |z|)
  // (2/|z|)^(1/3): 8 |z|^(1/3) steps leave 1e-18 of whatever the start was.
  const double size = std::abs(z);
  const int start = 16 + std::max(count, static_cast<int>(std::ceil(size + 8 * std::cbrt(size))));
  constexpr double tiny = 1e-290;
  std::vector<Number> ratio(count);
  Number here = 0;
  for (int n = start; n >= 1; --n) {
    Number inverse = static_cast<double>(2 * n + 1) / z - here;
    if (inverse == Number(0)) inverse = tiny;
    here = 1.0 / inverse;
    if (n <= count) ratio[n - 1] = here;
  }
  return ratio;
}

}  // namespace

int mie_term_count(double size_parameter) {
  return static_cast<int>(std::ceil(size_parameter + 4.7 * std::cbrt(size_parameter) + 4));
}

MieCoefficients mie_coefficients(double size_parameter, Complex refractive_index) {
  const double x = size_parameter;
  const Complex m = refractive_index;
  assert(x > 0 && m.real() > 0 && m.imag() >= 0);
  const int terms = mie_term_count(x);
  const Complex z = m * x;
  const std::vector<Complex> inner = riccati_bessel_ratios(z, terms + 1);
  const std::vector<double> outer = riccati_bessel_ratios(x, terms + 1);

  MieCoefficients sphere{x, std::vector<Complex>(terms), std::vector<Complex>(terms), std::vector<double>(terms)};
  // psi_n = x j_n and chi_n = -x y_n. chi grows with n, so that upward is its stable direction everywhere. psi is
  // computed upward while it oscillates and by its ratios when it decays, so that neither loses digits.
  double psi_before = std::cos(x), psi = std::sin(x);
  double chi_before = -std::sin(x), chi = std::cos(x);
  for (int n = 1; n <= terms; ++n) {
    const double chi_next = (2 * n - 1) / x * chi - chi_before;
    chi_before = chi;
    chi = chi_next;
    const bool falling = n >= x;
    const double psi_next = falling ? outer[n - 1] * psi : (2 * n - 1) / x * psi - psi_before;
    psi_before = psi;
    psi = psi_next;

    const Complex derivative = (n + 1.0) / z - inner[n];
    const Complex electric = derivative / m + n / x;
    const Complex magnetic = m * derivative + n / x;
    // The factors of psi_n are D_n(mx)/m - D_n(x) and m D_n(mx) - D_n(x). Written by the ratios, the second lacks its
    // leading terms, which would cancel for small spheres.
    const Complex a_psi =
        falling ? ((n + 1) / x * (1.0 / (m * m) - 1.0) - inner[n] / m + outer[n]) * psi : electric * psi - psi_before;
    const Complex b_psi = falling ? (outer[n] - m * inner[n]) * psi : magnetic * psi - psi_before;
    const Complex a_chi = electric * chi - chi_before;
    const Complex b_chi = magnetic * chi - chi_before;
    constexpr Complex i(0, 1);
    const Complex a_below = a_psi - i * a_chi;
    const Complex b_below = b_psi - i * b_chi;
    sphere.a[n - 1] = a_psi / a_below;
    sphere.b[n - 1] = b_psi / b_below;
    // Re a - |a|^2 = Re[a (1 - a)*], in whose numerator the Wronskian psi_{n-1} chi_n - psi_n chi_{n-1} = 1 is left.
    sphere.absorbed[n - 1] =
        m.imag() > 0 ? -(derivative / m).imag() / std::norm(a_below) - (m * derivative).imag() / std::norm(b_below) : 0;
  }
  return sphere;
}

MieEfficiencies mie_efficiencies(const MieCoefficients& sphere) {
  const auto& a = sphere.a;
  const auto& b = sphere.b;
  double scattering = 0, absorption = 0, forwardness = 0;
  Complex backward = 0;
  const auto product = [](Complex u, Complex v) { return u.real() * v.real() + u.imag() * v.imag(); };
  // From the last term to the first: the small ones are added before they drown.
  for (int n = static_cast<int>(a.size()); n >= 1; --n) {
    const Complex an = a[n - 1], bn = b[n - 1];
    const double weight = 2 * n + 1;
    scattering += weight * (std::norm(an) + std::norm(bn));
    absorption += weight * sphere.absorbed[n - 1];
    backward += (n % 2 == 0 ? weight : -weight) * (an - bn);
    if (n < static_cast<int>(a.size())) {
      forwardness += n * (n + 2.0) / (n + 1.0) * (product(an, a[n]) + product(bn, b[n]));
    }
    forwardness += weight / (n * (n + 1.0)) * product(an, bn);
  }
  const double scale = 2 / (sphere.size_parameter * sphere.size_parameter);
  MieEfficiencies efficiencies;
  efficiencies.scattering = scale * scattering;
  efficiencies.absorption = scale * absorption;
  efficiencies.extinction = efficiencies.scattering + efficiencies.absorption;
  efficiencies.backscatter = scale / 2 * std::norm(backward);
  efficiencies.asymmetry_parameter = 2 * forwardness / scattering;
  return efficiencies;
}

void mie_angular_functions(double cos_angle, std::span<double> plus, std::span<double> minus) {
  assert(plus.size() == minus.size());
  // Wiscombe's (1980) form of the upward recurrences, which is stable and has no division by a small number.
  double before = 0, pi = 1;
  for (std::size_t index = 0; index < plus.size(); ++index) {
    const double n = static_cast<double>(index) + 1;
    const double s = cos_angle * pi;
    const double t = s - before;
    const double tau = n * t - before;
    const double weight = (2 * n + 1) / (n * (n + 1));
    plus[index] = weight * (pi + tau);
    minus[index] = weight * (pi - tau);
    before = pi;
    pi = s + (n + 1) / n * t;
  }
}

MieAmplitudes mie_amplitudes(const MieCoefficients& sphere, double cos_angle) {
  std::vector<double> plus(sphere.a.size()), minus(sphere.a.size());
  mie_angular_functions(cos_angle, plus, minus);
  Complex sum = 0, difference = 0;
  for (std::size_t n = plus.size(); n-- > 0;) {
    sum += (sphere.a[n] + sphere.b[n]) * plus[n];
    difference += (sphere.a[n] - sphere.b[n]) * minus[n];
  }
  return {(sum + difference) / 2.0, (sum - difference) / 2.0};
}

}  // namespace cloudbow
