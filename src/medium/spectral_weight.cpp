#include "cloudbow/medium/spectral_weight.hpp"

#include <fmt/format.h>

#include <cassert>
#include <limits>

#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/planck.hpp"

namespace cloudbow {
namespace {

constexpr double cm1_times_um = 1e4;  // wavenumber [cm-1] times wavelength [um]

double wavelength_um(double wavenumber_cm1) {
  return wavenumber_cm1 > 0 ? cm1_times_um / wavenumber_cm1 : std::numeric_limits<double>::infinity();
}

/// Power in an interval, all g-points together.
double power_in(const GasModel& model, std::size_t interval) {
  const GasModel::Spectrum& spectrum = model.spectrum();
  if (model.light() == GasModel::Light::solar) return spectrum.solar[interval];
  return PlanckFunction::over({wavelength_um(spectrum.upper[interval]), wavelength_um(spectrum.lower[interval])})
      .radiance(weight_temperature_k);
}

}  // namespace

SpectralWeight weight_of_point(const GasModel& model, int point) {
  assert(point >= 0 && point < model.points());
  const GasModel::Spectrum& spectrum = model.spectrum();
  SpectralWeight result;
  const auto add = [&](double wavenumber, double weight) {
    result.wavenumber_cm1.push_back(wavenumber);
    result.weight.push_back(weight);
  };
  for (std::size_t n = 0; n < spectrum.lower.size(); ++n) {
    const double lower = spectrum.lower[n], upper = spectrum.upper[n], share = model.share_of_interval(point, n);
    if (!(share > 0 && upper > lower)) continue;
    const double weight = share * power_in(model, n) / (upper - lower);
    if (!result.weight.empty() && result.wavenumber_cm1.back() < lower) {
      add(result.wavenumber_cm1.back(), 0);
      add(lower, 0);
    }
    add(lower, weight);
    add(upper, weight);
  }
  if (result.weight.empty()) {
    throw InputError(fmt::format(
        "gas model: g-point {} has no share of any interval (found 0, allowed > 0 in one); take another model",
        point + 1));
  }
  return result;
}

std::array<double, 2> wavelengths_of(const GasModel& model) {
  const GasModel::Spectrum& spectrum = model.spectrum();
  assert(!spectrum.lower.empty());
  return {wavelength_um(spectrum.upper.back()), wavelength_um(spectrum.lower.front())};
}

}  // namespace cloudbow
