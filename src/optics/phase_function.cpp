#include "cloudbow/optics/phase_function.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/legendre_series.hpp"
#include "cloudbow/optics/phase_table.hpp"

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

/// Number of the moments g^l above 1e-17.
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
  PhaseTable table = make_phase_table(angle_deg, value);
  const double mean = table.mean();
  for (double& v : table.value) v /= mean;
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
