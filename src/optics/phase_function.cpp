#include "cloudbow/optics/phase_function.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "cloudbow/core/error.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow {
namespace {

void check_asymmetry(double g) {
  if (!(g > -1 && g < 1))
    throw InputError(fmt::format("phase function: asymmetry parameter is {} (allowed: -1 < g < 1)", g));
}

double henyey_greenstein_value(double g, double cos_angle) {
  // (1-g)^2 + 2g(1-mu), and its mirror image for g < 0: no cancellation at the peak, unlike 1 + g^2 - 2 g mu.
  const double a = std::abs(g), x = g < 0 ? -cos_angle : cos_angle;
  const double base = (1 - a) * (1 - a) + 2 * a * (1 - x);
  return (1 - a) * (1 + a) / (base * std::sqrt(base));
}

/// How many of the moments g^l stand above 1e-17.
int henyey_greenstein_moment_count(double g) {
  constexpr int most = 65536;
  if (g == 0) return 1;
  return static_cast<int>(std::min<double>(most, 1 + std::ceil(std::log(1e-17) / std::log(std::abs(g)))));
}

std::vector<double> sample(const std::function<double(int)>& moment, int count) {
  std::vector<double> moments(count);
  for (int l = 0; l < count; ++l) moments[l] = moment(l);
  return moments;
}

/// Clenshaw's recurrence for sum (2l+1) chi_l P_l(x).
double legendre_sum(std::span<const double> moments, double x) {
  double next = 0, after_next = 0;
  for (int l = static_cast<int>(moments.size()) - 1; l >= 0; --l) {
    const double here =
        (2 * l + 1) * moments[l] + (2 * l + 1.0) / (l + 1) * x * next - (l + 1.0) / (l + 2) * after_next;
    after_next = std::exchange(next, here);
  }
  return next;
}

/// A function given at ascending nodes mu, linear between.
struct PiecewiseLinear {
  std::vector<double> mu;
  std::vector<double> value;

  double operator()(double x) const {
    const auto right = std::clamp<std::ptrdiff_t>(std::upper_bound(mu.begin(), mu.end(), x) - mu.begin(), 1,
                                                  static_cast<std::ptrdiff_t>(mu.size()) - 1);
    const double t = (x - mu[right - 1]) / (mu[right] - mu[right - 1]);
    return (1 - t) * value[right - 1] + t * value[right];
  }

  double mean() const {
    double integral = 0;
    for (std::size_t i = 1; i < mu.size(); ++i) integral += (mu[i] - mu[i - 1]) * (value[i] + value[i - 1]) / 2;
    return integral / 2;
  }

  /// (1/2) int P P_l dmu by Gauss-Legendre on each segment, with nodes enough for the waves of P_l in it.
  std::vector<double> moments(int count) const {
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
};

PiecewiseLinear checked_table(std::span<const double> angle_deg, std::span<const double> value) {
  const auto reject = [](const std::string& problem) { throw InputError("phase function table: " + problem); };
  if (angle_deg.size() != value.size() || angle_deg.size() < 2) {
    reject(
        fmt::format("{} angles and {} values (allowed: as many of each, at least 2)", angle_deg.size(), value.size()));
  }
  const auto last = static_cast<std::ptrdiff_t>(angle_deg.size()) - 1;
  if (angle_deg[0] != 0 || angle_deg[last] != 180) {
    reject(fmt::format("angles run from {} to {} degrees (allowed: 0 to 180)", angle_deg[0], angle_deg[last]));
  }
  PiecewiseLinear table;
  for (std::ptrdiff_t i = last; i >= 0; --i) {
    if (!(value[i] >= 0) || std::isinf(value[i])) {
      reject(fmt::format("value {} at {} degrees (allowed: finite numbers >= 0)", value[i], angle_deg[i]));
    }
    const double mu = i == last ? -1 : std::cos(angle_deg[i] * std::numbers::pi / 180);
    if (i < last && !(angle_deg[i] < angle_deg[i + 1])) {
      reject(fmt::format("{} degrees is followed by {} (allowed: ascending angles)", angle_deg[i], angle_deg[i + 1]));
    }
    if (i < last && !(mu > table.mu.back())) {
      reject(fmt::format("{} and {} degrees are too close to tell apart by their cosines", angle_deg[i],
                         angle_deg[i + 1]));
    }
    table.mu.push_back(mu);
    table.value.push_back(value[i]);
  }
  const double mean = table.mean();
  if (!(mean > 0)) reject("all values are 0 (allowed: a function with a positive mean)");
  for (double& v : table.value) v /= mean;
  return table;
}

}  // namespace

PhaseFunction PhaseFunction::isotropic() {
  PhaseFunction p;
  p.moments_ = {1};
  p.exact_ = [](double) { return 1.0; };
  p.key_ = "isotropic";
  return p;
}

PhaseFunction PhaseFunction::rayleigh() {
  PhaseFunction p;
  p.moments_ = {1, 0, 0.1};
  p.exact_ = [](double mu) { return 0.75 * (1 + mu * mu); };
  p.key_ = "rayleigh";
  return p;
}

PhaseFunction PhaseFunction::henyey_greenstein(double g) {
  check_asymmetry(g);
  PhaseFunction p;
  p.closed_moment_ = [g](int l) { return std::pow(g, l); };
  p.moments_ = sample(p.closed_moment_, henyey_greenstein_moment_count(g));
  p.exact_ = [g](double mu) { return henyey_greenstein_value(g, mu); };
  p.key_ = fmt::format("henyey-greenstein {}", g);
  return p;
}

PhaseFunction PhaseFunction::double_henyey_greenstein(double g_forward, double g_backward, double forward_weight) {
  check_asymmetry(g_forward);
  check_asymmetry(g_backward);
  if (!(forward_weight >= 0 && forward_weight <= 1)) {
    throw InputError(fmt::format("phase function: forward weight is {} (allowed: 0 to 1)", forward_weight));
  }
  PhaseFunction p;
  p.closed_moment_ = [=](int l) {
    return forward_weight * std::pow(g_forward, l) + (1 - forward_weight) * std::pow(g_backward, l);
  };
  p.moments_ = sample(p.closed_moment_,
                      std::max(henyey_greenstein_moment_count(g_forward), henyey_greenstein_moment_count(g_backward)));
  p.exact_ = [=](double mu) {
    return forward_weight * henyey_greenstein_value(g_forward, mu) +
           (1 - forward_weight) * henyey_greenstein_value(g_backward, mu);
  };
  p.key_ = fmt::format("double-henyey-greenstein {} {} {}", g_forward, g_backward, forward_weight);
  return p;
}

PhaseFunction PhaseFunction::legendre(std::vector<double> moments) {
  constexpr double rounding = 1e-6;  // of published tables
  if (moments.empty() || !(std::abs(moments[0] - 1) <= rounding)) {
    throw InputError(
        fmt::format("phase function: Legendre moment 0 is {} (allowed: 1; moments go without the factor 2l+1)",
                    moments.empty() ? "missing" : fmt::format("{}", moments[0])));
  }
  moments[0] = 1;
  for (std::size_t l = 1; l < moments.size(); ++l) {
    if (!(std::abs(moments[l]) <= 1)) {
      throw InputError(fmt::format(
          "phase function: Legendre moment {} is {} (allowed: -1 to 1, without the factor 2l+1)", l, moments[l]));
    }
  }
  PhaseFunction p;
  p.key_ = fmt::format("legendre {}", fmt::join(moments, " "));
  p.moments_ = std::move(moments);
  return p;
}

PhaseFunction PhaseFunction::table(std::span<const double> angle_deg, std::span<const double> value) {
  constexpr int moment_count = 1024;
  PiecewiseLinear table = checked_table(angle_deg, value);
  PhaseFunction p;
  p.moments_ = table.moments(moment_count);
  p.moments_[0] = 1;
  p.key_ = fmt::format("table {} {}", fmt::join(table.mu, " "), fmt::join(table.value, " "));
  p.exact_ = std::move(table);
  return p;
}

double PhaseFunction::operator()(double cos_angle) const {
  const double mu = std::clamp(cos_angle, -1.0, 1.0);
  return exact_ ? exact_(mu) : legendre_sum(moments_, mu);
}

double PhaseFunction::moment(int l) const {
  assert(l >= 0);
  if (l < static_cast<int>(moments_.size())) return moments_[l];
  return closed_moment_ ? closed_moment_(l) : 0;
}

bool PhaseFunction::is_isotropic() const {
  return std::all_of(moments_.begin() + 1, moments_.end(), [](double chi) { return chi == 0; });
}

}  // namespace cloudbow
