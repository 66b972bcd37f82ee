#include "cloudbow/optics/legendre_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

constexpr double rounding = 1e-3;        // of moments with three decimals, by which P = 1 + mu falls below 0
constexpr double largest_ringing = 0.1;  // of the mean: beyond it single scattering is wrong by as much

}  // namespace

double legendre_sum(std::span<const double> moments, double x) {
  double next = 0, after_next = 0;
  for (int l = static_cast<int>(moments.size()) - 1; l >= 0; --l) {
    const double here =
        (2 * l + 1) * moments[l] + (2 * l + 1.0) / (l + 1) * x * next - (l + 1.0) / (l + 2) * after_next;
    after_next = std::exchange(next, here);
  }
  return next;
}

LeastValue least_value(std::span<const double> moments) {
  constexpr std::size_t per_degree = 8;
  const std::size_t steps = std::clamp<std::size_t>(per_degree * moments.size(), 180, 1000);
  LeastValue least{legendre_sum(moments, 1), 0};
  for (std::size_t n = 1; n <= steps; ++n) {
    const double angle = 180.0 * static_cast<double>(n) / static_cast<double>(steps);
    const double value = legendre_sum(moments, n == steps ? -1 : std::cos(angle * std::numbers::pi / 180));
    if (value < least.value) least = {value, angle};
  }
  return least;
}

SeriesTerms terms_of(std::span<const double> moments) {
  SeriesTerms terms;
  for (std::size_t l = 0; l < moments.size(); ++l) {
    const double term = static_cast<double>(2 * l + 1) * std::abs(moments[l]);
    if (term > 0) terms.last = term;
    terms.largest = std::max(terms.largest, term);
  }
  return terms;
}

double least_allowed(std::span<const double> moments) {
  const SeriesTerms terms = terms_of(moments);
  const bool was_cut = terms.last <= fallen * terms.largest;
  return -rounding - (was_cut ? std::min(terms.last, largest_ringing) : 0);
}

std::string check_not_negative(std::span<const double> moments) {
  const LeastValue least = least_value(moments);
  const double allowed = least_allowed(moments);
  if (least.value < allowed) {
    throw InputError(
        fmt::format("phase function: negative (found {:.3g} at {:.4g} degrees beside a mean of 1; allowed: >= 0) "
                    "moments with the factor 2l+1 left in look so: divide moment l by 2l+1; so does a series that is "
                    "cut too early: give more moments",
                    least.value, least.angle_deg));
  }
  if (least.value >= -rounding) return {};
  return fmt::format(
      "phase function: falls to {:.3g} at {:.4g} degrees, because the series ends with moment {}; more "
      "moments make radiances more accurate",
      least.value, least.angle_deg, moments.size() - 1);
}

}  // namespace cloudbow
