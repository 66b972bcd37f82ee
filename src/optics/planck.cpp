#include "cloudbow/optics/planck.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cloudbow/core/error.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow {
namespace {

// The SI's exact constants (CODATA 2018, Tiesinga et al., Rev. Mod. Phys. 93, 025010).
constexpr double planck_constant = 6.62607015e-34;   // J s
constexpr double speed_of_light = 299792458;         // m s-1
constexpr double boltzmann_constant = 1.380649e-23;  // J K-1
constexpr double um_per_m = 1e6;
/// 2 h c^2 in W m-2 sr-1 um4: over wavelength_um^5 it is per um.
constexpr double first_constant =
    2 * planck_constant * speed_of_light * speed_of_light * um_per_m * um_per_m * um_per_m * um_per_m;
/// h c / k in um K.
constexpr double second_constant = planck_constant * speed_of_light / boltzmann_constant * um_per_m;

constexpr double shortest_um = .1, longest_um = 1e4;

// Integrals are over x = second_constant / (wavelength temperature), of f(x) = x^3 / (e^x - 1).

constexpr double whole_integral =
    std::numbers::pi * std::numbers::pi * std::numbers::pi * std::numbers::pi / 15;  // from 0 to infinity
constexpr double no_radiance_from = 700;  // x: e^x is near the largest number
constexpr double widest_quadrature = 2;   // of x: Gauss-Legendre takes all digits up to here, series beyond
constexpr int quadrature_nodes = 16;

double integrand(double x) { return x * x * x / std::expm1(x); }

/// From x > 0 to infinity: 1 / (e^x - 1) = sum_n e^-nx, term by term.
double integral_above(double x) {
  double sum = 0;
  for (int n = 1;; ++n) {
    const double term = std::exp(-n * x) * (((x + 3. / n) * x + 6. / (n * n)) * x + 6. / (n * n * n)) / n;
    sum += term;
    if (!(term > 1e-17 * sum)) return sum;
  }
}

/// From 0 to x <= 1.5: x^3 (1/3 - x/8 + sum_k B_2k x^2k / ((2k + 3) (2k)!)), with the Bernoulli numbers B_2k.
double integral_below(double x) {
  // B_2k / (2k)! from k = 1 on: their ratio tends to -1 / (2 pi)^2, so that 14 terms have all digits at x = 1.5.
  constexpr std::array<double, 14> coefficient{1. / 12,
                                               -1. / 720,
                                               1. / 30240,
                                               -1. / 1209600,
                                               1. / 47900160,
                                               -691. / 1307674368000,
                                               1. / 74724249600,
                                               -3617. / 10670622842880000,
                                               43867. / 5109094217170944000,
                                               -174611. / 802857662698291200000.,
                                               77683. / 14101100039391805440000.,
                                               -236364091. / 1693824136731743669452800000.,
                                               657931. / 186134520519971831808000000.,
                                               -3392780147. / 37893265687455865519472640000000.};
  const double square = x * x;
  double sum = 0;
  for (int k = static_cast<int>(coefficient.size()); k > 0; --k)
    sum = square * (sum + coefficient[static_cast<std::size_t>(k - 1)] / (2 * k + 3));
  return square * x * (1. / 3 - x / 8 + sum);
}

/// Integral of f between two ends, and the mean steepness weighted by f.
struct BandIntegral {
  double value = 0;
  double steepness = 0;
};

/// The width is given by itself: in narrow bands high - low would cancel, as would the difference of two series.
BandIntegral integrate(double low, double high, double width) {
  if (low > no_radiance_from || width <= 0) return {};
  if (width <= widest_quadrature) {
    static const GaussLegendre rule = make_gauss_legendre(quadrature_nodes);
    const double half = width / 2, middle = low + half;
    double sum = 0, steep = 0;
    for (std::size_t n = 0; n < rule.node.size(); ++n) {
      const double x = middle + half * rule.node[n];
      const double denominator = std::expm1(x);
      const double weighted = rule.weight[n] * x * x * x / denominator;
      sum += weighted;
      steep += weighted * (x + x / denominator);  // d ln B / d ln T at this wavelength
    }
    return {half * sum, sum > 0 ? steep / sum : 1};
  }
  constexpr double series_change = 1.5;
  const double tail = high > no_radiance_from ? 0 : integral_above(high);
  const double value = low > series_change ? integral_above(low) - tail : whole_integral - integral_below(low) - tail;
  // By parts: d(T^4 integral)/dT, whose ends move as x = second_constant / (wavelength T).
  const double ends = (low > 0 ? low * integrand(low) : 0) - (tail > 0 ? high * integrand(high) : 0);
  return {value, value > 0 ? 4 + ends / value : 1};
}

/// Band radiance is this, times T^4, times the integral.
constexpr double band_constant =
    first_constant / (second_constant * second_constant * second_constant * second_constant);

struct BandRadiance {
  double value = 0;
  double steepness = 0;
};

BandRadiance radiance_of_band(const std::array<double, 2>& band_um, double temperature_k) {
  if (temperature_k <= 0) return {};
  const double low = second_constant / (band_um[1] * temperature_k);
  const double high = second_constant / (band_um[0] * temperature_k);
  const double width = std::isinf(band_um[1]) ? high : high * ((band_um[1] - band_um[0]) / band_um[1]);
  const BandIntegral integral = integrate(low, high, width);
  // In this order neither the power nor the product overflows before the radiance does.
  return {band_constant * integral.value * temperature_k * temperature_k * temperature_k * temperature_k,
          integral.steepness};
}

double fifth_power(double x) { return x * x * x * x * x; }

double temperature_at(double wavelength_um, double radiance) {
  const double ratio = first_constant / fifth_power(wavelength_um) / radiance;
  // Of radiances near the smallest number the ratio overflows; only its logarithm matters.
  const double x = std::isinf(ratio) ? std::log(first_constant / fifth_power(wavelength_um)) - std::log(radiance)
                                     : std::log1p(ratio);
  return second_constant / (wavelength_um * x);
}

/// ln B is concave in ln T and convex in 1/T. Newton steps in ln T from below and in 1/T from above approach the root
/// and never pass it.
double temperature_of_band(const std::array<double, 2>& band_um, double radiance) {
  double temperature = 0;
  if (std::isinf(band_um[1])) {
    temperature = std::sqrt(std::sqrt(radiance / (band_constant * whole_integral)));
  } else {
    temperature = temperature_at((band_um[0] + band_um[1]) / 2, radiance / (band_um[1] - band_um[0]));
  }
  const double wanted = std::log(radiance);
  constexpr int most_steps = 200;
  constexpr double converged = 1e-14;
  for (int step = 0; step < most_steps; ++step) {
    const BandRadiance found = radiance_of_band(band_um, temperature);
    if (found.value <= 0) {
      // So cold that the radiance is below the smallest number.
      temperature = std::max(2 * temperature, second_constant / (band_um[1] * no_radiance_from));
      continue;
    }
    const double excess = (std::log(found.value) - wanted) / found.steepness;
    const double next = excess < 0 ? temperature * std::exp(-excess) : temperature / (1 + excess);
    const bool done = std::abs(next - temperature) <= converged * temperature;
    temperature = next;
    if (done) break;
  }
  return temperature;
}

}  // namespace

PlanckFunction PlanckFunction::at(double wavelength_um) {
  if (!(wavelength_um >= shortest_um && wavelength_um <= longest_um)) {
    throw InputError(fmt::format("wavelength of thermal emission: out of range (found {} um, allowed {} to {} um)",
                                 wavelength_um, shortest_um, longest_um));
  }
  PlanckFunction planck;
  planck.wavelength_um_ = wavelength_um;
  return planck;
}

PlanckFunction PlanckFunction::over(std::array<double, 2> band_um) {
  if (!(band_um[0] > 0 && band_um[0] < band_um[1] && std::isfinite(band_um[0]))) {
    throw InputError(
        fmt::format("band of thermal emission: wrong ends (found {} to {} um, allowed two ascending wavelengths > 0)",
                    band_um[0], band_um[1]));
  }
  PlanckFunction planck;
  planck.band_um_ = band_um;
  return planck;
}

double PlanckFunction::radiance(double temperature_k) const {
  if (temperature_k <= 0) return 0;
  if (wavelength_um_ <= 0) return radiance_of_band(band_um_, temperature_k).value;
  const double x = second_constant / (wavelength_um_ * temperature_k);
  return first_constant / fifth_power(wavelength_um_) * std::exp(-x) / -std::expm1(-x);
}

double PlanckFunction::brightness_temperature(double radiance) const {
  if (radiance <= 0) return 0;
  if (!std::isfinite(radiance)) return radiance;
  return wavelength_um_ > 0 ? temperature_at(wavelength_um_, radiance) : temperature_of_band(band_um_, radiance);
}

}  // namespace cloudbow
