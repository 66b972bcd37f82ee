#include "transport/gather/plane_blur.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "transport/rays/march.hpp"

namespace cloudbow {
namespace {

constexpr double least_blur = .15;  // columns; below it a blur changes nothing

// Cell-integrated Gaussian along an axis of n columns.
template <class Real>
struct Kernel {
  int reach = 0;
  std::vector<Real> weight{Real(1)};  // [2 reach + 1]

  Kernel(double sigma, int n) {
    if (sigma < least_blur) return;
    reach = std::min(static_cast<int>(std::ceil(3 * sigma)), n / 2);
    std::vector<double> integral;
    for (int d = -reach; d <= reach + 1; ++d) integral.push_back(.5 * std::erf((d - .5) / sigma / std::numbers::sqrt2));
    const double all = integral.back() - integral.front();
    weight.clear();
    for (int d = 0; d <= 2 * reach; ++d) weight.push_back(static_cast<Real>((integral[d + 1] - integral[d]) / all));
  }
};

template <class Real>
void add_scaled(Real scale, const Real* __restrict from, int n, Real* __restrict to) {
  for (int i = 0; i < n; ++i) to[i] += scale * from[i];
}

template <class Real>
bool is_zero(const Real* row, int n) {
  return std::all_of(row, row + n, [](Real value) { return value == 0; });
}

int mirrored(int i, int n) { return i < 0 ? -1 - i : i < n ? i : 2 * n - 1 - i; }

template <class Real>
void blur_along_x(std::vector<Real>& field, int nx, int ny, bool periodic, const Kernel<Real>& kernel) {
  const int reach = kernel.reach;
  std::vector<Real> wide(nx + 2 * static_cast<std::size_t>(reach));
  for (int j = 0; j < ny; ++j) {
    Real* const row = field.data() + static_cast<std::size_t>(j) * nx;
    if (is_zero(row, nx)) continue;
    std::fill(wide.begin(), wide.end(), Real(0));
    for (int d = 0; d <= 2 * reach; ++d) add_scaled(kernel.weight[d], row, nx, wide.data() + d);
    std::copy_n(wide.data() + reach, nx, row);
    if (periodic) {
      add_scaled(Real(1), wide.data(), reach, row + nx - reach);
      add_scaled(Real(1), wide.data() + nx + reach, reach, row);
    } else {
      for (int d = 0; d < reach; ++d) {
        row[d] += wide[reach - 1 - d];
        row[nx - 1 - d] += wide[nx + reach + d];
      }
    }
  }
}

template <class Real>
void blur_along_y(std::vector<Real>& field, int nx, int ny, bool periodic, const Kernel<Real>& kernel) {
  std::vector<Real> result(field.size(), Real(0));
  for (int j = 0; j < ny; ++j) {
    const Real* const row = field.data() + static_cast<std::size_t>(j) * nx;
    if (is_zero(row, nx)) continue;
    for (int d = -kernel.reach; d <= kernel.reach; ++d) {
      const int to = periodic ? wrapped(j + d, ny) : mirrored(j + d, ny);
      add_scaled(kernel.weight[d + kernel.reach], row, nx, result.data() + static_cast<std::size_t>(to) * nx);
    }
  }
  field.swap(result);
}

}  // namespace

template <class Real>
void blur_plane(std::vector<Real>& field, const BoxGrid& box, double sigma_m) {
  const Kernel<Real> along_x(sigma_m / box.dx_m, box.nx);
  const Kernel<Real> along_y(sigma_m / box.dy_m, box.ny);
  if (along_x.reach > 0) blur_along_x(field, box.nx, box.ny, box.periodic, along_x);
  if (along_y.reach > 0) blur_along_y(field, box.nx, box.ny, box.periodic, along_y);
}

double least_blur_m(const BoxGrid& box) { return least_blur * std::min(box.dx_m, box.dy_m); }

template void blur_plane<float>(std::vector<float>&, const BoxGrid&, double);
template void blur_plane<double>(std::vector<double>&, const BoxGrid&, double);

}  // namespace cloudbow
