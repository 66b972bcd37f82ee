#include "cloudbow/results/tradeoff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

bool same_places(const std::vector<double>& a, const std::vector<double>& b) {
  // Tolerance relative to the extent: rounding of a transform, not another grid.
  const double slack = a.empty() ? 0 : 1e-6 * (std::abs(a.back() - a.front()) + std::abs(a.front()));
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [slack](double x, double y) { return std::abs(x - y) <= slack; });
}

void check_same_grid(const BoundaryResult& result, const BoundaryResult& truth) {
  if (!same_places(result.x_m, truth.x_m) || !same_places(result.y_m, truth.y_m)) {
    throw InputError(fmt::format(
        "{}: other columns than the result that is compared with it (found {} x {} columns from ({:g}, {:g}) m, "
        "allowed {} x {} from ({:g}, {:g}) m)",
        truth.file, truth.x_m.size(), truth.y_m.size(), truth.x_m.front(), truth.y_m.front(), result.x_m.size(),
        result.y_m.size(), result.x_m.front(), result.y_m.front()));
  }
  if (!same_places(result.wavelengths_um, truth.wavelengths_um)) {
    throw InputError(
        fmt::format("{}: other wavelengths than the result that is compared with it (found {}, allowed the same {})",
                    truth.file, truth.wavelengths_um.size(), result.wavelengths_um.size()));
  }
}

double rms_over_mean(const std::vector<double>& value, const std::vector<double>& truth) {
  double square = 0, sum = 0;
  for (std::size_t n = 0; n < truth.size(); ++n) {
    square += (value[n] - truth[n]) * (value[n] - truth[n]);
    sum += truth[n];
  }
  const auto count = static_cast<double>(truth.size());
  return square == 0 ? 0 : std::sqrt(square / count) / (sum / count);
}

}  // namespace

FluxErrors flux_errors(const BoundaryResult& result, const BoundaryResult& truth) {
  check_same_grid(result, truth);
  FluxErrors errors;
  for (std::size_t w = 0; w < truth.fluxes.size(); ++w) {
    const BoundaryFluxes &a = result.fluxes[w], &b = truth.fluxes[w];
    errors.domain = std::max({errors.domain, 100 * std::abs(a.reflectance - b.reflectance),
                              100 * std::abs(a.transmittance - b.transmittance)});
    errors.up = std::max(errors.up, 100 * rms_over_mean(a.up_at_top, b.up_at_top));
    errors.down = std::max(errors.down, 100 * rms_over_mean(a.down_at_bottom, b.down_at_bottom));
  }
  return errors;
}

std::vector<std::size_t> pareto_front(std::span<const double> cost, std::span<const double> error) {
  assert(cost.size() == error.size());
  std::vector<std::size_t> order(cost.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [error](std::size_t n) { return !std::isfinite(error[n]); });
  std::stable_sort(order.begin(), order.end(), [cost, error](std::size_t a, std::size_t b) {
    return std::pair(cost[a], error[a]) < std::pair(cost[b], error[b]);
  });
  double least = std::numeric_limits<double>::infinity();
  std::erase_if(order, [&least, error](std::size_t n) {
    const bool beaten = error[n] >= least;
    least = std::min(least, error[n]);
    return beaten;
  });
  return order;
}

}  // namespace cloudbow
