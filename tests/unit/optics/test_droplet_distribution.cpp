// Distributions of droplets. Truth: their moments by numerical integration.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "../near_with_report.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/mie_sphere.hpp"
#include "cloudbow/optics/mie_table.hpp"
#include "cloudbow/optics/refractive_index.hpp"

namespace cloudbow {
namespace {

/// <r^(p)> sums by brute force over the range that the distribution says to be all.
double moment_ratio(const DropletDistribution& distribution, int above, int below) {
  double upper = 0, lower = 0;
  const double first = std::log(distribution.smallest_radius_um()), last = std::log(distribution.largest_radius_um());
  constexpr int steps = 4000;
  for (int n = 0; n <= steps; ++n) {
    const double r = std::exp(first + (last - first) * n / steps);
    const double weight = std::exp(distribution.log_density(r) - distribution.log_density(distribution.mode(2))) * r;
    upper += weight * std::pow(r, above);
    lower += weight * std::pow(r, below);
  }
  return upper / lower;
}

// Definition (Hansen & Travis 1974): r_e = <r^3>/<r^2>, v = <r^4><r^2>/<r^3>^2 - 1. Droplets left out matter by 1e-7.
TEST(DropletDistribution, HasItsEffectiveRadiusAndVariance) {
  for (const auto kind : {DistributionKind::gamma, DistributionKind::lognormal}) {
    for (const double variance : {0.002, 0.1, 0.25, 0.4}) {
      const DropletDistribution distribution(kind, 7.5, variance);
      EXPECT_NEAR(moment_ratio(distribution, 3, 2) / 7.5, 1, 1e-6) << distribution_name(kind) << variance;
      EXPECT_NEAR(moment_ratio(distribution, 4, 3) / moment_ratio(distribution, 3, 2) - 1, variance, 2e-6)
          << distribution_name(kind);
    }
  }
  EXPECT_THROW(DropletDistribution(DistributionKind::gamma, 10, 0.5), InputError);
  EXPECT_THROW(DropletDistribution(DistributionKind::gamma, -1, 0.1), InputError);
  EXPECT_THROW(DropletDistribution(DistributionKind::lognormal, 1, 0), InputError);
}

}  // namespace
}  // namespace cloudbow
