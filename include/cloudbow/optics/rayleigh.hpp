// Dependence of scattering by air molecules on the wavelength.
#pragma once

namespace cloudbow {

/// Vertical optical depth of the whole atmosphere over a surface at 1013.25 hPa (Hansen & Travis 1974, Eq. 2.30); what
/// matters here is its ratio at two wavelengths.
/// @param wavelength_um > 0; made for sunlight from the near ultraviolet on
double rayleigh_optical_depth(double wavelength_um);

}  // namespace cloudbow
