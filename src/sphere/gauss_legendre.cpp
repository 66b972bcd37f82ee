#include "cloudbow/sphere/gauss_legendre.hpp"

#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

namespace cloudbow {
namespace {

/// P_n(x) and its derivative.
std::pair<double, double> legendre_and_slope(int n, double x) {
  double previous = 1, value = x;
  for (int l = 2; l <= n; ++l) previous = std::exchange(value, ((2 * l - 1) * x * value - (l - 1) * previous) / l);
  return {value, n * (x * value - previous) / (x * x - 1)};
}

}  // namespace

GaussLegendre make_gauss_legendre(int count) {
  assert(count >= 1);
  GaussLegendre rule{std::vector<double>(count, 0.0), std::vector<double>(count, 2.0)};
  if (count == 1) return rule;
  for (int i = 0; i < count / 2 + count % 2; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5));
    if (2 * i + 1 == count) x = 0;
    for (int step = 0; step < 100; ++step) {
      const auto [value, slope] = legendre_and_slope(count, x);
      const double change = value / slope;
      x -= change;
      if (std::abs(change) < 1e-15) break;
    }
    const double slope = legendre_and_slope(count, x).second;
    rule.node[i] = -x;
    rule.node[count - 1 - i] = x;
    rule.weight[i] = rule.weight[count - 1 - i] = 2 / ((1 - x * x) * slope * slope);
  }
  return rule;
}

}  // namespace cloudbow
