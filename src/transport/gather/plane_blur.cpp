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

int mirrored(int i, int n) { return i < 0 ? -1 - i : i < n ? i : 2 * n - 1 - i; }

// to[i] = sum over d of weight[d] at(d)[i], for n elements of a row. Some of them at a time: their sums stay in
// registers.
template <class Real, class At>
void weighted_sum(const std::vector<Real>& weight, int n, const At& at, Real* to) {
  using Rays = Pack<Real>;
  constexpr int size = Rays::size;
  int i = 0;
  for (; i + 4 * size <= n; i += 4 * size) {
    typename Rays::Value a{}, b{}, c{}, e{};
    for (std::size_t d = 0; d < weight.size(); ++d) {
      const Real* const from = at(d) + i;
      a += weight[d] * Rays::load(from);
      b += weight[d] * Rays::load(from + size);
      c += weight[d] * Rays::load(from + 2 * size);
      e += weight[d] * Rays::load(from + 3 * size);
    }
    Rays::store_all(a, to + i);
    Rays::store_all(b, to + i + size);
    Rays::store_all(c, to + i + 2 * size);
    Rays::store_all(e, to + i + 3 * size);
  }
  for (; i + size <= n; i += size) {
    typename Rays::Value a{};
    for (std::size_t d = 0; d < weight.size(); ++d) a += weight[d] * Rays::load(at(d) + i);
    Rays::store_all(a, to + i);
  }
  for (; i < n; ++i) {
    Real a = 0;
    for (std::size_t d = 0; d < weight.size(); ++d) a += weight[d] * at(d)[i];
    to[i] = a;
  }
}

template <class Real>
void blur_along_x(std::vector<Real>& field, int nx, int ny, bool periodic, const Kernel<Real>& kernel) {
  const int reach = kernel.reach;
  std::vector<Real> wide(nx + 2 * static_cast<std::size_t>(reach));  // a row and what lies beyond its ends
  for (int j = 0; j < ny; ++j) {
    Real* const row = field.data() + static_cast<std::size_t>(j) * nx;
    std::copy_n(row, nx, wide.data() + reach);
    for (int d = 0; d < reach; ++d) {
      wide[d] = row[periodic ? nx - reach + d : reach - 1 - d];
      wide[reach + nx + d] = row[periodic ? d : nx - 1 - d];
    }
    const auto moved = [&](std::size_t d) -> const Real* { return wide.data() + d; };
    weighted_sum(kernel.weight, nx, moved, row);
  }
}

template <class Real>
void blur_along_y(std::vector<Real>& field, int nx, int ny, bool periodic, const Kernel<Real>& kernel) {
  std::vector<Real> result(field.size());
  std::vector<const Real*> row(kernel.weight.size());
  for (int j = 0; j < ny; ++j) {
    for (int d = 0; d < static_cast<int>(row.size()); ++d) {
      const int from = j + d - kernel.reach;
      row[d] = field.data() + static_cast<std::size_t>(periodic ? wrapped(from, ny) : mirrored(from, ny)) * nx;
    }
    const auto moved = [&](std::size_t d) { return row[d]; };
    weighted_sum(kernel.weight, nx, moved, result.data() + static_cast<std::size_t>(j) * nx);
  }
  field.swap(result);
}

// A moving mean over 2 reach + 1 columns and, with a lower weight, the two beyond them.
struct MovingMean {
  int reach;
  double beyond;  // weight of those two over that of the others

  double norm() const { return 1 / (2 * reach + 1 + 2 * beyond); }
};

// With this variance, in columns squared. At most as wide as n columns.
MovingMean moving_mean(double variance, int n) {
  const int widest = (n - 3) / 2;
  // Without the two beyond, the variance of the mean is reach (reach + 1) / 3.
  const int reach = static_cast<int>(std::min<double>((std::sqrt(1 + 12 * variance) - 1) / 2, widest));
  const double next = reach + 1;
  if (reach == widest) return {reach, 0};
  return {reach, (2 * reach + 1) * (variance - reach * next / 3) / (2 * (next * next - variance))};
}

// From this width on, in columns, three moving means replace the Gaussian. They take the same time for any width.
constexpr double wide_blur = 10;
constexpr int moving_means = 3;

bool is_wide(double sigma, int n) { return sigma >= wide_blur && n > 4 * wide_blur; }

// value(i) of a row of n that is periodic, or mirrored at its ends.
int inside(int i, int n, bool periodic) { return periodic ? wrapped(i, n) : mirrored(i, n); }

template <class Real>
void spread_along_x(std::vector<Real>& field, int nx, int ny, bool periodic, double sigma) {
  const MovingMean mean = moving_mean(sigma * sigma / moving_means, nx);
  const int margin = mean.reach + 1;
  const double norm = mean.norm();
  std::vector<double> wide(static_cast<std::size_t>(nx) + 2 * static_cast<std::size_t>(margin));
  for (int j = 0; j < ny; ++j) {
    Real* const row = field.data() + static_cast<std::size_t>(j) * nx;
    std::copy_n(row, nx, wide.data() + margin);
    for (int pass = 0; pass < moving_means; ++pass) {
      double* const first = wide.data() + margin;
      for (int d = 1; d <= margin; ++d) {
        first[-d] = first[inside(-d, nx, periodic)];
        first[nx - 1 + d] = first[inside(nx - 1 + d, nx, periodic)];
      }
      double sum = 0;
      for (int d = -mean.reach; d <= mean.reach; ++d) sum += first[d];
      // The value before the window is still needed when its column has been written.
      double before = first[-margin];
      for (int i = 0; i < nx; ++i) {
        const double after = first[i + margin];
        const double leaves = wide[static_cast<std::size_t>(i) + 1];
        wide[static_cast<std::size_t>(i)] = norm * (sum + mean.beyond * (before + after));
        sum += after - leaves;
        before = leaves;
      }
      std::copy_backward(wide.data(), wide.data() + nx, wide.data() + margin + nx);
    }
    for (int i = 0; i < nx; ++i)
      row[i] = static_cast<Real>(wide[static_cast<std::size_t>(margin) + static_cast<std::size_t>(i)]);
  }
}

template <class Real>
void spread_along_y(std::vector<Real>& field, int nx, int ny, bool periodic, double sigma) {
  const MovingMean mean = moving_mean(sigma * sigma / moving_means, ny);
  const int margin = mean.reach + 1;
  const double norm = mean.norm();
  std::vector<Real> result(field.size());
  std::vector<double> sum(static_cast<std::size_t>(nx));
  for (int pass = 0; pass < moving_means; ++pass) {
    const auto row = [&](int j) { return field.data() + static_cast<std::size_t>(inside(j, ny, periodic)) * nx; };
    std::fill(sum.begin(), sum.end(), 0.);
    for (int d = -mean.reach; d <= mean.reach; ++d) {
      const Real* const of = row(d);
      for (int i = 0; i < nx; ++i) sum[static_cast<std::size_t>(i)] += static_cast<double>(of[i]);
    }
    for (int j = 0; j < ny; ++j) {
      const Real* __restrict const before = row(j - margin);
      const Real* __restrict const after = row(j + margin);
      const Real* __restrict const leaves = row(j - mean.reach);
      Real* __restrict const to = result.data() + static_cast<std::size_t>(j) * nx;
      double* __restrict const window = sum.data();
#pragma omp simd
      for (int i = 0; i < nx; ++i) {
        const auto next = static_cast<double>(after[i]);
        to[i] = static_cast<Real>(norm * (window[i] + mean.beyond * (static_cast<double>(before[i]) + next)));
        window[i] += next - static_cast<double>(leaves[i]);
      }
    }
    field.swap(result);
  }
}

}  // namespace

template <class Real>
void blur_plane(std::vector<Real>& field, const BoxGrid& box, double sigma_m) {
  const auto along = [&](double sigma, int n, const auto& blur, const auto& spread) {
    if (is_wide(sigma, n)) {
      spread(field, box.nx, box.ny, box.periodic, sigma);
    } else if (const Kernel<Real> kernel(sigma, n); kernel.reach > 0) {
      blur(field, box.nx, box.ny, box.periodic, kernel);
    }
  };
  along(sigma_m / box.dx_m, box.nx, blur_along_x<Real>, spread_along_x<Real>);
  along(sigma_m / box.dy_m, box.ny, blur_along_y<Real>, spread_along_y<Real>);
}

BlurWidths::BlurWidths(const BoxGrid& box, double growth)
    : least_m_(least_blur * std::min(box.dx_m, box.dy_m)), growth_(growth) {
  const double widest_m = std::max(box.nx * box.dx_m, box.ny * box.dy_m);
  widest_ = 1 + static_cast<int>(std::lround(std::log(widest_m / least_m_) / std::log(growth_)));
}

int BlurWidths::number(double width_m) const {
  if (!(width_m >= least_m_)) return 0;
  // Widths may be beyond any int: the logarithm is bounded first.
  const double steps = std::min<double>(std::log(width_m / least_m_) / std::log(growth_), widest_);
  return std::min(1 + static_cast<int>(std::lround(steps)), widest_);
}

double BlurWidths::width_m(int number) const { return number == 0 ? 0 : least_m_ * std::pow(growth_, number - 1); }

template void blur_plane<float>(std::vector<float>&, const BoxGrid&, double);
template void blur_plane<double>(std::vector<double>&, const BoxGrid&, double);

}  // namespace cloudbow
