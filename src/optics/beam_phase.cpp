#include "cloudbow/optics/beam_phase.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cloudbow {
namespace {

// Nodes are densest near 0, because most light is there: lambda = scale (exp(step node) - 1), the last at 60.
constexpr double scale = .05;
constexpr double deepest = 60;
const double step = std::log1p(deepest / scale) / (BeamPhase::nodes - 1);

constexpr std::size_t most_moments = 4096;
constexpr double least_moment = 1e-9;

}  // namespace

BeamPhase::BeamPhase(const PhaseFunction& phase, const DeltaM& truncation) : phase_(phase) {
  const double f = truncation.forward_fraction;
  if (f == 0) return;
  order_ = static_cast<int>(truncation.truncated.moments().size());
  const std::span<const double> moments = phase.moments();
  std::size_t last = std::min(moments.size(), most_moments);
  while (last > static_cast<std::size_t>(order_) && std::abs(moments[last - 1]) < least_moment) --last;
  beyond_ = last > static_cast<std::size_t>(order_) ? last - order_ : 0;
  change_.reserve(nodes * beyond_);
  for (int n = 0; n < nodes; ++n) {
    const double lambda = scale * std::expm1(step * n);
    for (std::size_t l = order_; l < order_ + beyond_; ++l) {
      const double r = moments[l] / f;
      const double share = f * static_cast<double>(2 * l + 1);
      change_.push_back(share * (std::exp(-lambda) - (1 - r) * std::exp(-lambda * (1 - r)) - r));
    }
  }
}

double BeamPhase::place(double lambda) {
  return std::clamp(std::log1p(std::max(0., lambda) / scale) / step, 0., nodes - 1.);
}

std::vector<double> BeamPhase::at(double cos_angle) const {
  const double x = std::clamp(cos_angle, -1., 1.);
  std::vector<double> value(nodes, phase_(x));
  const double resolved = std::numbers::pi / std::max(order_, 1);
  const double fade = std::clamp(2 - 2 * std::acos(x) / resolved, 0., 1.);
  const double straight_on = fade * fade * (3 - 2 * fade);
  if (straight_on == 0) return value;
  std::vector<double> legendre(beyond_);  // P_l, l >= N
  double before = 1, current = x;         // P_0, P_1
  for (std::size_t l = 0; l < order_ + beyond_; ++l) {
    if (l >= static_cast<std::size_t>(order_)) legendre[l - order_] = before;
    const double degree = static_cast<double>(l + 1);
    const double next = ((2 * degree + 1) * x * current - degree * before) / (degree + 1);
    before = current;
    current = next;
  }
  for (int n = 0; n < nodes; ++n) {
    const double* const change = change_.data() + n * beyond_;
    for (std::size_t l = 0; l < beyond_; ++l) value[n] += straight_on * change[l] * legendre[l];
  }
  return value;
}

}  // namespace cloudbow
