#include "cloudbow/optics/rayleigh.hpp"

namespace cloudbow {

double rayleigh_optical_depth(double wavelength_um) {
  const double inverse_square = 1 / (wavelength_um * wavelength_um);
  return 0.008569 * inverse_square * inverse_square *
         (1 + inverse_square * (0.0113 + inverse_square * 0.00013));  // Hansen & Travis 1974, Eq. 2.30
}

}  // namespace cloudbow
