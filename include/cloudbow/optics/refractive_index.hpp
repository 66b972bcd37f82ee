// Complex refractive indices of water and ice, m = n + i k.
#pragma once

#include <complex>
#include <string>

namespace cloudbow {

enum class Substance { water, ice };

/// Wavelengths [um] at which both substances are known.
inline constexpr double shortest_index_wavelength = 0.2;
inline constexpr double longest_index_wavelength = 1000;

/// n linear and log k linear in the logarithm of the wavelength, between the rows of
/// - water (25 C): D. J. Segelstein, "The complex refractive index of water", thesis, University of Missouri-Kansas
/// City,
///   1981, thinned in smooth ranges;
/// - ice (-7 C): S. G. Warren & R. E. Brandt, J. Geophys. Res. 113, D14220, 2008.
/// @throws InputError for wavelengths outside 0.2 to 1000 um.
std::complex<double> refractive_index(Substance substance, double wavelength_um);

/// Density [g/cm3]: water 1, as tables of cloud properties take it; ice 0.917 (0 C).
double density_g_cm3(Substance substance);

/// Source of the numbers, in one line.
std::string refractive_index_source(Substance substance);

}  // namespace cloudbow
