#include "cloudbow/optics/phase_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "cloudbow/core/error.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow {

double PhaseTable::operator()(double x) const {
  const auto right = std::clamp<std::ptrdiff_t>(std::upper_bound(mu.begin(), mu.end(), x) - mu.begin(), 1,
                                                static_cast<std::ptrdiff_t>(mu.size()) - 1);
  const double t = (x - mu[right - 1]) / (mu[right] - mu[right - 1]);
  return (1 - t) * value[right - 1] + t * value[right];
}

double PhaseTable::mean() const {
  double integral = 0;
  for (std::size_t i = 1; i < mu.size(); ++i) integral += (mu[i] - mu[i - 1]) * (value[i] + value[i - 1]) / 2;
  return integral / 2;
}

std::vector<double> PhaseTable::moments(int count) const {
  std::vector<double> chi(count, 0.0);
  std::map<int, GaussLegendre> rules;
  for (std::size_t i = 1; i < mu.size(); ++i) {
    const double width = mu[i] - mu[i - 1];
    // P_l is nearly a cosine of l times the angle: 8 + phase nodes are exact to rounding, and (l+3)/2 are exact
    // altogether.
    const double phase = count * (std::acos(mu[i - 1]) - std::acos(mu[i]));
    const int nodes = std::min(count / 2 + 2, 8 + static_cast<int>(phase));
    const auto [rule, is_new] = rules.try_emplace(nodes);
    if (is_new) rule->second = make_gauss_legendre(nodes);
    for (int n = 0; n < nodes; ++n) {
      const double t = (1 + rule->second.node[n]) / 2, x = mu[i - 1] + t * width;
      const double weighted = rule->second.weight[n] * width / 4 * ((1 - t) * value[i - 1] + t * value[i]);
      double legendre = 1, next = x;
      for (int l = 0; l < count; ++l) {
        chi[l] += weighted * legendre;
        legendre = std::exchange(next, ((2 * l + 3) * x * next - (l + 1) * legendre) / (l + 2));
      }
    }
  }
  return chi;
}

PhaseTable make_phase_table(std::span<const double> angle_deg, std::span<const double> value) {
  const auto reject = [](const std::string& problem) { throw InputError("phase function table: " + problem); };
  if (angle_deg.size() != value.size() || angle_deg.size() < 2) {
    reject(
        fmt::format("{} angles and {} values (allowed: as many of each, at least 2)", angle_deg.size(), value.size()));
  }
  const auto last = static_cast<std::ptrdiff_t>(angle_deg.size()) - 1;
  if (angle_deg[0] != 0 || angle_deg[last] != 180) {
    reject(fmt::format("angles run from {} to {} degrees (allowed: 0 to 180)", angle_deg[0], angle_deg[last]));
  }
  PhaseTable table;
  for (std::ptrdiff_t i = last; i >= 0; --i) {
    if (!(value[i] >= 0) || std::isinf(value[i])) {
      reject(fmt::format("value {} at {} degrees (allowed: finite numbers >= 0)", value[i], angle_deg[i]));
    }
    const double mu = i == last ? -1 : std::cos(angle_deg[i] * std::numbers::pi / 180);
    if (i < last && !(angle_deg[i] < angle_deg[i + 1])) {
      reject(fmt::format("{} degrees is followed by {} (allowed: ascending angles)", angle_deg[i], angle_deg[i + 1]));
    }
    if (i < last && !(mu > table.mu.back())) {
      reject(fmt::format("{} and {} degrees have the same cosine", angle_deg[i], angle_deg[i + 1]));
    }
    table.mu.push_back(mu);
    table.value.push_back(value[i]);
  }
  if (!(table.mean() > 0)) reject("all values are 0 (allowed: a function with a positive mean)");
  return table;
}

}  // namespace cloudbow
