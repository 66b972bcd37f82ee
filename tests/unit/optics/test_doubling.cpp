// The reference solver of these tests, itself tested against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "cloudbow/sphere/gauss_legendre.hpp"
#include "reference/doubling.hpp"

namespace cloudbow::reference {
namespace {

double henyey_greenstein_moment(int l) { return std::pow(0.85, l); }
double isotropic_moment(int l) { return l == 0 ? 1 : 0; }

TEST(Doubling, AbsorbingSlabObeysBeer) {
  const std::vector<double> mu = {1, 0.3};
  const auto fluxes = plane_parallel_fluxes(isotropic_moment, mu, 2, 0);
  for (std::size_t i = 0; i < mu.size(); ++i) {
    EXPECT_NEAR(fluxes[i].transmittance, std::exp(-2 / mu[i]), 1e-7);  // second order in a first slab of 2/8192
    EXPECT_NEAR(fluxes[i].reflectance, 0, 1e-15);
  }
}

TEST(Doubling, ConservativeSlabLosesNothing) {
  const std::vector<double> mu = {1, 0.1};
  for (const double tau : {0.1, 10.0, 100.0}) {
    for (const auto& [r, t] : plane_parallel_fluxes(henyey_greenstein_moment, mu, tau, 1)) EXPECT_NEAR(r + t, 1, 1e-8);
  }
}

TEST(Doubling, DeepIsotropicSlabHasTheAlbedoOfChandrasekhar) {
  // Radiative Transfer (1950): plane albedo of a half space 1 - H(mu0) sqrt(1 - ssa), with
  // 1/H(mu) = sqrt(1 - ssa) + (ssa/2) int_0^1 x H(x) / (mu + x) dx.
  const double ssa = 0.9;
  const GaussLegendre rule = make_gauss_legendre(64);
  std::vector<double> x, h(64, 1.0);
  for (const double node : rule.node) x.push_back((1 + node) / 2);
  const auto inverse_h = [&](double mu) {
    double sum = std::sqrt(1 - ssa);
    for (std::size_t j = 0; j < x.size(); ++j) sum += ssa / 2 * rule.weight[j] / 2 * x[j] * h[j] / (mu + x[j]);
    return sum;
  };
  for (int iteration = 0; iteration < 200; ++iteration) {
    std::vector<double> next;
    for (const double mu : x) next.push_back(1 / inverse_h(mu));
    h = next;
  }
  const std::vector<double> mu = {1, 0.5, 0.1};
  const auto fluxes = plane_parallel_fluxes(isotropic_moment, mu, 60, ssa);
  for (std::size_t i = 0; i < mu.size(); ++i) {
    EXPECT_NEAR(fluxes[i].reflectance, 1 - std::sqrt(1 - ssa) / inverse_h(mu[i]), 1e-6);
  }
}

}  // namespace
}  // namespace cloudbow::reference
