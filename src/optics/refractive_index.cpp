#include "cloudbow/optics/refractive_index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cloudbow/core/error.hpp"
#include "refractive_index_tables.hpp"

namespace cloudbow {

std::complex<double> refractive_index(Substance substance, double wavelength_um) {
  if (!(wavelength_um >= shortest_index_wavelength && wavelength_um <= longest_index_wavelength)) {
    throw InputError(fmt::format("refractive index of {}: wavelength out of range (found {} um, allowed {} to {} um)",
                                 substance == Substance::water ? "water" : "ice", wavelength_um,
                                 shortest_index_wavelength, longest_index_wavelength));
  }
  const auto rows = substance == Substance::water ? water_index_rows() : ice_index_rows();
  const auto right = std::upper_bound(rows.begin() + 1, rows.end() - 1, wavelength_um,
                                      [](double w, const IndexRow& row) { return w < row.wavelength_um; });
  const IndexRow& a = *(right - 1);
  const IndexRow& b = *right;
  const double t = std::log(wavelength_um / a.wavelength_um) / std::log(b.wavelength_um / a.wavelength_um);
  return {(1 - t) * a.n + t * b.n, a.k * std::pow(b.k / a.k, t)};
}

double density_g_cm3(Substance substance) { return substance == Substance::water ? 1.0 : 0.917; }

std::string refractive_index_source(Substance substance) {
  return substance == Substance::water
             ? "Segelstein 1981, The complex refractive index of water, University of Missouri-Kansas City (25 C)"
             : "Warren & Brandt 2008, J. Geophys. Res. 113, D14220 (-7 C)";
}

}  // namespace cloudbow
