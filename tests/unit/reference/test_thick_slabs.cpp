// The reference solver of these tests, itself tested against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "cloudbow/sphere/gauss_legendre.hpp"
#include "reference/thick_slabs.hpp"

namespace cloudbow::reference::thick_slabs {
namespace {

// Doubled forty times, a thin slab's rounding is a few hundred times that of double.
constexpr double kRounding = 1e-12;

double henyey_greenstein_moment(int l) { return std::pow(0.85, l); }
double isotropic_moment(int l) { return l == 0 ? 1 : 0; }

TEST(ThickSlabs, AbsorbingSlabObeysBeer) {
  const std::vector<double> mu = {1, 0.3};
  const auto fluxes = plane_parallel_fluxes(isotropic_moment, mu, 2, 0);
  for (std::size_t i = 0; i < mu.size(); ++i) {
    EXPECT_NEAR(fluxes[i].transmittance, std::exp(-2 / mu[i]), kRounding);
    EXPECT_NEAR(fluxes[i].reflectance, 0, 1e-15);
  }
}

TEST(ThickSlabs, ConservativeSlabLosesNothing) {
  const std::vector<double> mu = {1, 0.1};
  for (const double tau : {0.1, 10.0, 1e5}) {
    for (const auto& [r, t] : plane_parallel_fluxes(henyey_greenstein_moment, mu, tau, 1)) EXPECT_NEAR(r + t, 1, 1e-10);
    for (const auto& [r, t] : plane_parallel_fluxes(henyey_greenstein_moment, mu, tau, 1, 1)) EXPECT_NEAR(r, 1, 1e-10);
  }
}

TEST(ThickSlabs, ThickConservativeSlabTransmitsAsDiffusionSays) {
  // van de Hulst, Multiple Light Scattering (1980): T (tau + 2 q0) is the same for all thick slabs, q0 = .7104461 being
  // Hopf's constant for isotropic scattering.
  const std::vector<double> mu = {1, 0.5};
  const double q0 = 0.7104460896;
  const auto thick = plane_parallel_fluxes(isotropic_moment, mu, 100, 1),
             thicker = plane_parallel_fluxes(isotropic_moment, mu, 1e5, 1);
  for (std::size_t i = 0; i < mu.size(); ++i)
    EXPECT_NEAR(thicker[i].transmittance / thick[i].transmittance * (1e5 + 2 * q0) / (100 + 2 * q0), 1, 1e-5);
}

TEST(ThickSlabs, ThinSlabScattersOnce) {
  // R = ssa b tau / mu0 to first order in tau / mu0, b = 1/2 of isotropic scattering.
  const std::vector<double> mu = {1, 0.01};
  const auto fluxes = plane_parallel_fluxes(isotropic_moment, mu, 1e-8, 0.7);
  for (std::size_t i = 0; i < mu.size(); ++i) {
    const double scattered = 0.7 * 1e-8 / mu[i];
    EXPECT_NEAR(fluxes[i].reflectance / scattered, 0.5, 1e-5);
    EXPECT_NEAR((1 - fluxes[i].transmittance) / scattered, 1 / 0.7 - 0.5, 1e-5);
  }
}

TEST(ThickSlabs, SurfaceReflectsThroughAnAbsorber) {
  // What comes back is A T(mu0) 2 E3(tau): 2 E3(1) = .2193839 (Abramowitz & Stegun, table 5.1).
  const std::vector<double> mu = {0.5};
  const auto fluxes = plane_parallel_fluxes(isotropic_moment, mu, 1, 0, 0.3);
  EXPECT_NEAR(fluxes[0].reflectance, 0.3 * std::exp(-2) * 0.2193839, 1e-7);
  EXPECT_NEAR(fluxes[0].transmittance, std::exp(-2), kRounding);
}

TEST(ThickSlabs, DeepIsotropicSlabHasTheAlbedoOfChandrasekhar) {
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
}  // namespace cloudbow::reference::thick_slabs
