#include "transport/driver/precision.hpp"

#include <algorithm>
#include <cmath>

namespace cloudbow {
namespace {

// Rounding acts like a source of light in every cell. In a thick medium that hardly absorbs, such light needs as many
// scatterings to leave as the sun's. In a very thick cell the radiance differs from its source by less than float
// resolves. These fields converge in double alone. Measured on conservative slabs: optical depth 100 is fine in float,
// 200 is not; cells of optical depth 25 in absorbing air are fine, 250 are not.
constexpr double thickest_cell_in_float = 50;
constexpr double thickest_domain_in_float = 120;

}  // namespace

bool too_thick_for_float(const OpticalGrid& grid) {
  const BoxGrid& box = grid.box;
  double optical_depth = 0;  // summed over the columns
  double absorbing = 0;      // of it
  for (int k = 0; k < box.nz(); ++k) {
    const double thickness = box.thickness_m(k);
    const double edge = std::min({thickness, box.nx > 1 ? box.dx_m : thickness, box.ny > 1 ? box.dy_m : thickness});
    for (std::size_t c = grid.first_cell(k); c < grid.first_cell(k + 1); ++c) {
      const double absorption = grid.absorption[c];
      const double extinction = grid.extinction(c);
      if (extinction * edge > thickest_cell_in_float) return true;
      optical_depth += extinction * thickness;
      absorbing += absorption * thickness;
    }
  }
  // Light comes no deeper than the diffusion length, here with isotropic scattering, which is short.
  const double diffusion_length = absorbing > 0 ? std::sqrt(optical_depth / (3 * absorbing)) : HUGE_VAL;
  const double mean_depth = optical_depth / static_cast<double>(box.columns());
  return std::min(mean_depth, 3 * diffusion_length) > thickest_domain_in_float;
}

}  // namespace cloudbow
