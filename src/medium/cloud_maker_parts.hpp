// Parts that the makers of clouds share.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "cloudbow/medium/cloud_makers.hpp"

namespace cloudbow {

/// Extinction [1/m] of the whole domain, cell (i, j, k) at (k*ny + j)*nx + i.
using DenseField = std::vector<double>;

inline constexpr double moist_adiabatic_liquid_water_gradient = 2.0e-3;  // g/m3 per m, at 10 degrees C and 900 hPa

/// Extinction [1/m] of droplets in the geometric limit (efficiency 2), from the liquid water content [g/m3]. Their
/// number is fixed, 100 per cm3. The cube of the effective radius is 1/0.8 of that of the volume mean radius: beta = 3
/// w / (2 rho r_e). So beta grows as w^(2/3) (Brenguier et al. 2000, doi
/// 10.1175/1520-0469(2000)057<0803:RPOBLC>2.0.CO;2).
inline double droplet_extinction(double liquid_water_content) {
  constexpr double pi = 3.14159265358979323846;
  constexpr double water_density = 1e6;   // g/m3
  constexpr double droplet_number = 1e8;  // 1/m3
  constexpr double width_parameter = 0.8;
  if (liquid_water_content <= 0) return 0;
  const double effective_radius =
      std::cbrt(3 * liquid_water_content / (4 * pi * water_density * width_parameter * droplet_number));
  return 1.5 * liquid_water_content / (water_density * effective_radius);
}

struct MakerGrid {
  explicit MakerGrid(const CloudMakerOptions& options)
      : nx(options.cells[0]),
        ny(options.cells[1]),
        nz(options.cells[2]),
        dx(options.voxel_size_m[0]),
        dy(options.voxel_size_m[1]),
        dz(options.voxel_size_m[2]) {}

  std::size_t columns() const { return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny); }
  std::size_t cells() const { return columns() * static_cast<std::size_t>(nz); }
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(ny) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(nx) +
           static_cast<std::size_t>(i);
  }
  double width_x() const { return nx * dx; }
  double width_y() const { return ny * dy; }
  double height() const { return nz * dz; }

  int nx, ny, nz;
  double dx, dy, dz;
};

/// Options are checked; `base` is the lowest cloudy level, 0 <= base < nz.
DenseField make_cumulus(const MakerGrid& grid, int base, double cover, std::uint64_t seed);
DenseField make_stratocumulus(const MakerGrid& grid, int base, double cover, std::uint64_t seed);

/// The value that `fraction` of the numbers exceed, 0 < fraction <= 1; lower than all for 1.
double value_exceeded_by(double fraction, std::vector<double> numbers);

}  // namespace cloudbow
