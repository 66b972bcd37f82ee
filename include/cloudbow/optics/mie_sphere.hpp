// Scattering of a plane wave by a homogeneous sphere (Mie 1908). Notation: Bohren & Huffman, "Absorption and Scattering
// of Light by Small Particles" (1983), chapter 4.
#pragma once

#include <complex>
#include <span>
#include <vector>

namespace cloudbow {

/// Coefficients a_n, b_n of the scattered field, n = 1, 2, ... at index n - 1 (Bohren & Huffman Eq. 4.88).
struct MieCoefficients {
  double size_parameter = 0;
  std::vector<std::complex<double>> a;
  std::vector<std::complex<double>> b;
  /// [n-1] Re a_n - |a_n|^2 + Re b_n - |b_n|^2, the absorbed part, by a formula without that difference: accurate in
  /// all digits however small k is, and exactly 0 for k = 0.
  std::vector<double> absorbed;
};

/// Terms that a sphere of size parameter x needs: beyond them |a_n| and |b_n| are below 1e-9 of the first for any
/// index. Wiscombe (1980), Appl. Opt. 19, 1505, with a wider margin.
int mie_term_count(double size_parameter);

/// @param size_parameter x = 2 pi radius / wavelength, > 0, up to 1e5.
/// @param refractive_index m = n + i k relative to the medium around the sphere, n > 0, k >= 0.
MieCoefficients mie_coefficients(double size_parameter, std::complex<double> refractive_index);

/// Cross-sections over the geometric one, pi radius^2.
struct MieEfficiencies {
  double extinction = 0;  ///< scattering + absorption
  double scattering = 0;
  double absorption = 0;
  double backscatter = 0;  ///< 4 |S(180 degrees)|^2 / x^2, as Bohren & Huffman's program gives it
  double asymmetry_parameter = 0;
};

/// Bohren & Huffman Eqs. 4.61, 4.62 and the asymmetry parameter on their page 120.
MieEfficiencies mie_efficiencies(const MieCoefficients& sphere);

/// S_1 (polarised across the scattering plane) and S_2 (along it).
struct MieAmplitudes {
  std::complex<double> s1;
  std::complex<double> s2;
};

/// At one cosine of the scattering angle, Bohren & Huffman Eq. 4.74.
MieAmplitudes mie_amplitudes(const MieCoefficients& sphere, double cos_angle);

/// The angular functions at one cosine: plus[n-1] = pi_n + tau_n, minus[n-1] = pi_n - tau_n (Bohren & Huffman
/// Eq. 4.47), times (2n+1)/(n(n+1)), so that S_1 + S_2 = sum (a_n + b_n) plus and S_1 - S_2 = sum (a_n - b_n) minus.
void mie_angular_functions(double cos_angle, std::span<double> plus, std::span<double> minus);

}  // namespace cloudbow
