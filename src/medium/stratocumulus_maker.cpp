// A stratocumulus layer: lognormal optical depth with a -5/3 spectrum over a flat base.
#include <algorithm>
#include <cmath>
#include <complex>

#include "cloud_maker_parts.hpp"
#include "random.hpp"

namespace cloudbow {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double adiabatic_fraction = 0.8;
constexpr double log_deviation = 0.35;  // of the logarithm of optical depth
constexpr double outer_waves = 2;       // waves in the longer side of the domain; fewer: white spectrum

std::vector<std::complex<double>> unit_roots(int n) {
  std::vector<std::complex<double>> roots;
  for (int m = 0; m < n; ++m) roots.emplace_back(std::cos(2 * pi * m / n), std::sin(2 * pi * m / n));
  return roots;
}

int signed_wave(int m, int n) { return 2 * m > n ? m - n : m; }

/// Periodic Gaussian field, mean 0 and variance 1. The spectrum over both wave numbers falls as K^(-8/3), that along
/// any line as k^(-5/3).
std::vector<double> turbulent_field(const MakerGrid& grid, std::uint64_t seed) {
  using Complex = std::complex<double>;
  const auto [nx, ny] = std::pair(grid.nx, grid.ny);
  const double outer = outer_waves / std::max(grid.width_x(), grid.width_y());
  const double exponent = ny == 1 ? -5.0 / 12 : -2.0 / 3;  // of the square of the amplitude's wave number
  Random random(seed);
  std::vector<Complex> waves(grid.columns());
  for (int my = 0; my < ny; ++my) {
    for (int mx = 0; mx < nx; ++mx) {
      const double kx = signed_wave(mx, nx) / grid.width_x();
      const double ky = signed_wave(my, ny) / grid.width_y();
      const double amplitude = mx == 0 && my == 0 ? 0 : std::pow(kx * kx + ky * ky + outer * outer, exponent);
      const double re = random.normal();
      const double im = random.normal();
      waves[grid.index(mx, my, 0)] = amplitude * Complex(re, im);
    }
  }

  // The transform is done axis by axis: nx*ny*(nx + ny) products are negligible compared with solving the scene.
  const auto roots_x = unit_roots(nx);
  const auto roots_y = unit_roots(ny);
  std::vector<Complex> half(waves.size());
  for (int my = 0; my < ny; ++my) {
    for (int i = 0; i < nx; ++i) {
      Complex sum = 0;
      for (int mx = 0; mx < nx; ++mx)
        sum += waves[grid.index(mx, my, 0)] * roots_x[static_cast<std::size_t>(std::int64_t{mx} * i % nx)];
      half[grid.index(i, my, 0)] = sum;
    }
  }
  std::vector<double> field(waves.size());
  double variance = 0;
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      double sum = 0;
      for (int my = 0; my < ny; ++my) {
        sum += (half[grid.index(i, my, 0)] * roots_y[static_cast<std::size_t>(std::int64_t{my} * j % ny)]).real();
      }
      field[grid.index(i, j, 0)] = sum;
      variance += sum * sum / static_cast<double>(field.size());
    }
  }
  for (double& number : field) number /= std::sqrt(variance);
  return field;
}

}  // namespace

DenseField make_stratocumulus(const MakerGrid& grid, int base, double cover, std::uint64_t seed) {
  const auto turbulence = turbulent_field(grid, seed);
  const double threshold = cover < 1 ? std::exp(log_deviation * value_exceeded_by(cover, turbulence)) : 0;
  std::vector<double> depth;
  for (const double number : turbulence) depth.push_back(std::max(0.0, std::exp(log_deviation * number) - threshold));

  // Liquid water grows linearly above the base, extinction with its power 2/3 and optical depth with the power 5/3 of
  // thickness.
  const double deepest = *std::max_element(depth.begin(), depth.end());
  const double thickest = (grid.nz - base) * grid.dz;
  const double extinction_at_1_m = droplet_extinction(adiabatic_fraction * moist_adiabatic_liquid_water_gradient);
  const auto depth_below = [&](double height) { return 0.6 * extinction_at_1_m * std::pow(height, 5.0 / 3); };

  DenseField field(grid.cells(), 0.0);
  for (std::size_t column = 0; column < depth.size(); ++column) {
    const double thickness = thickest * std::pow(depth[column] / deepest, 0.6);
    for (int k = base; (k - base) * grid.dz < thickness; ++k) {
      const double bottom = (k - base) * grid.dz;
      const double top = std::min(thickness, bottom + grid.dz);
      field[static_cast<std::size_t>(k) * grid.columns() + column] = (depth_below(top) - depth_below(bottom)) / grid.dz;
    }
  }
  return field;
}

}  // namespace cloudbow
