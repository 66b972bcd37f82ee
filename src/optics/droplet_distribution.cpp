#include "cloudbow/optics/droplet_distribution.hpp"

#include <fmt/format.h>

#include <cmath>

#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

constexpr double smallest_variance = 1e-4;
constexpr double log_of_negligible = -18.42;  // ln 1e-8

}  // namespace

DropletDistribution::DropletDistribution(DistributionKind kind, double effective_radius_um, double effective_variance)
    : kind_(kind),
      effective_radius_um_(effective_radius_um),
      effective_variance_(effective_variance),
      log_geometric_radius_(std::log(effective_radius_um) - 2.5 * std::log1p(effective_variance)),
      log_width_squared_(std::log1p(effective_variance)) {
  if (!(effective_radius_um > 0) || std::isinf(effective_radius_um)) {
    throw InputError(fmt::format("effective radius: out of range (found {} um, allowed > 0)", effective_radius_um));
  }
  const double largest = kind == DistributionKind::gamma ? 0.45 : 2;
  if (!(effective_variance >= smallest_variance && effective_variance <= largest)) {
    throw InputError(fmt::format("effective variance: out of range for a {} distribution (found {}, allowed {} to {})",
                                 distribution_name(kind), effective_variance, smallest_variance, largest));
  }
}

double DropletDistribution::log_density(double radius_um) const {
  const double log_radius = std::log(radius_um);
  if (kind_ == DistributionKind::gamma) {
    const double v = effective_variance_;
    return (1 - 3 * v) / v * log_radius - radius_um / (effective_radius_um_ * v);
  }
  const double distance = log_radius - log_geometric_radius_;
  return -log_radius - distance * distance / (2 * log_width_squared_);
}

double DropletDistribution::mode(double power) const {
  // Of power ln r + ln n(r) + ln r: per ln r the density gains one r.
  const double v = effective_variance_;
  if (kind_ == DistributionKind::gamma) return ((1 - 3 * v) / v + power + 1) * effective_radius_um_ * v;
  return std::exp(log_geometric_radius_ + power * log_width_squared_);
}

double DropletDistribution::fallen_radius(double power, double from_um, double towards_factor) const {
  const auto height = [&](double radius) { return (power + 1) * std::log(radius) + log_density(radius); };
  const double limit = height(from_um) + log_of_negligible;
  double near = from_um, far = from_um;
  while (height(far) > limit) far *= towards_factor;
  for (int step = 0; step < 40; ++step) {
    const double middle = std::sqrt(near * far);
    (height(middle) > limit ? near : far) = middle;
  }
  return far;
}

double DropletDistribution::smallest_radius_um() const { return fallen_radius(2, mode(2), 0.7); }

double DropletDistribution::largest_radius_um() const { return fallen_radius(4, mode(4), 1.4); }

std::string distribution_name(DistributionKind kind) { return kind == DistributionKind::gamma ? "gamma" : "lognormal"; }

}  // namespace cloudbow
