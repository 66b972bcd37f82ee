#include "reference/scatterer.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace cloudbow::reference {

using std::numbers::pi;

Scatterer Scatterer::isotropic() { return {}; }

Scatterer Scatterer::rayleigh() {
  Scatterer result;
  result.kind_ = Kind::rayleigh;
  return result;
}

Scatterer Scatterer::henyey_greenstein(double g) {
  assert(std::abs(g) < 1);
  Scatterer result;
  result.kind_ = std::abs(g) < 1e-6 ? Kind::isotropic : Kind::henyey_greenstein;
  result.g_ = g;
  return result;
}

Scatterer Scatterer::table(std::span<const double> angle_deg, std::span<const double> value) {
  assert(angle_deg.size() == value.size() && angle_deg.size() >= 2);
  Scatterer result;
  result.kind_ = Kind::table;
  for (std::size_t n = angle_deg.size(); n-- > 0;) {
    result.cosine_.push_back(std::cos(angle_deg[n] * pi / 180));
    result.value_.push_back(value[n]);
  }
  result.cosine_.front() = -1;
  result.cosine_.back() = 1;
  result.cumulative_ = {0.0};
  for (std::size_t n = 1; n < value.size(); ++n) {
    result.cumulative_.push_back(result.cumulative_.back() + (result.cosine_[n] - result.cosine_[n - 1]) *
                                                                 (result.value_[n] + result.value_[n - 1]) / 2);
  }
  const double mean = result.cumulative_.back() / 2;
  for (double& v : result.value_) v /= mean;
  for (double& c : result.cumulative_) c /= 2 * mean;
  return result;
}

double Scatterer::operator()(double cos_angle) const {
  switch (kind_) {
    case Kind::isotropic:
      return 1;
    case Kind::rayleigh:
      return 0.75 * (1 + cos_angle * cos_angle);
    case Kind::henyey_greenstein: {
      const double square = 1 + g_ * g_ - 2 * g_ * cos_angle;
      return (1 - g_ * g_) / (square * std::sqrt(square));
    }
    case Kind::table:
      break;
  }
  const auto above = std::upper_bound(cosine_.begin() + 1, cosine_.end() - 1, cos_angle);
  const auto n = static_cast<std::size_t>(above - cosine_.begin());
  const double share = (cos_angle - cosine_[n - 1]) / (cosine_[n] - cosine_[n - 1]);
  return value_[n - 1] + share * (value_[n] - value_[n - 1]);
}

double Scatterer::cosine_at(double uniform) const {
  switch (kind_) {
    case Kind::isotropic:
      return 2 * uniform - 1;
    case Kind::rayleigh: {
      // mu^3 + 3 mu = 8 u - 4, by Cardano.
      const double half = 4 * uniform - 2, root = std::cbrt(half + std::sqrt(half * half + 1));
      return root - 1 / root;
    }
    case Kind::henyey_greenstein: {
      const double ratio = (1 - g_ * g_) / (1 - g_ + 2 * g_ * uniform);
      return std::clamp((1 + g_ * g_ - ratio * ratio) / (2 * g_), -1.0, 1.0);
    }
    case Kind::table:
      break;
  }
  const auto above = std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, uniform);
  const auto n = static_cast<std::size_t>(above - cumulative_.begin());
  // Of the trapezium of this interval: rest = value x + slope x^2 / 2, solved for x without cancellation.
  const double rest = 2 * (uniform - cumulative_[n - 1]), width = cosine_[n] - cosine_[n - 1];
  const double value = value_[n - 1], slope = (value_[n] - value) / width;
  const double denominator = value + std::sqrt(std::max(0.0, value * value + 2 * slope * rest));
  return denominator > 0 ? std::min(cosine_[n - 1] + 2 * rest / denominator, cosine_[n]) : cosine_[n];
}

}  // namespace cloudbow::reference
