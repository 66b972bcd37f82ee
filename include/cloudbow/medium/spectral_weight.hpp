// Spectral weights of g-points, by which optics are averaged for them.
#pragma once

#include <array>

#include "cloudbow/medium/gas_model.hpp"
#include "cloudbow/optics/spectral_mean.hpp"

namespace cloudbow {

/// Temperature [K] of the Planck spectrum that weights longwave optics.
inline constexpr double weight_temperature_k = 288;

/// Weight of a g-point by wavenumber, constant in each interval of the model: the share of the interval times spectrum.
/// That is the solar spectrum of the model, or the Planck radiance at weight_temperature_k, per wavenumber. Intervals
/// without a share are left out. The integral is the power, in W m-2 sr-1 or the unit of the solar spectrum.
/// @throws InputError if the point has no share of any interval.
SpectralWeight weight_of_point(const GasModel& model, int point);

/// Wavelengths [um] that the intervals of a model span; the second is infinite if they begin at 0 cm-1.
std::array<double, 2> wavelengths_of(const GasModel& model);

}  // namespace cloudbow
