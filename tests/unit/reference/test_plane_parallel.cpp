// The adding-doubling reference, itself tested: against closed forms, invariance and figures of discrete ordinates.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "../near_with_report.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"
#include "reference/plane_parallel.hpp"

namespace cloudbow::reference {
namespace {

// Doubled forty times, a thin slab's rounding is a few hundred times that of double.
constexpr double rounding = 1e-12;

double henyey_greenstein_moment(int l) { return std::pow(0.85, l); }
double isotropic_moment(int l) { return l == 0 ? 1 : 0; }
double rayleigh_moment(int l) { return l == 0 ? 1 : l == 2 ? 0.1 : 0; }

TEST(PlaneParallel, AbsorbingSlabObeysBeer) {
  const std::vector<double> mu = {1, 0.3};
  const auto fluxes = plane_parallel_fluxes(isotropic_moment, mu, 2, 0);
  for (std::size_t i = 0; i < mu.size(); ++i) {
    EXPECT_NEAR(fluxes[i].transmittance, std::exp(-2 / mu[i]), rounding);
    EXPECT_NEAR(fluxes[i].reflectance, 0, 1e-15);
  }
}

TEST(PlaneParallel, ConservativeSlabLosesNothing) {
  const std::vector<double> mu = {1, 0.1};
  for (const double tau : {0.1, 10.0, 1e5}) {
    for (const auto& [r, t] : plane_parallel_fluxes(henyey_greenstein_moment, mu, tau, 1)) EXPECT_NEAR(r + t, 1, 1e-10);
    for (const auto& [r, t] : plane_parallel_fluxes(henyey_greenstein_moment, mu, tau, 1, 1)) EXPECT_NEAR(r, 1, 1e-10);
  }
}

TEST(PlaneParallel, ThickConservativeSlabTransmitsAsDiffusionSays) {
  // van de Hulst, Multiple Light Scattering (1980): T (tau + 2 q0) is the same for all thick slabs, q0 = .7104461 being
  // Hopf's constant for isotropic scattering.
  const std::vector<double> mu = {1, 0.5};
  const double q0 = 0.7104460896;
  const auto thick = plane_parallel_fluxes(isotropic_moment, mu, 100, 1),
             thicker = plane_parallel_fluxes(isotropic_moment, mu, 1e5, 1);
  for (std::size_t i = 0; i < mu.size(); ++i)
    EXPECT_NEAR(thicker[i].transmittance / thick[i].transmittance * (1e5 + 2 * q0) / (100 + 2 * q0), 1, 1e-5);
}

TEST(PlaneParallel, ThinSlabScattersOnce) {
  // R = ssa b tau / mu0 to first order in tau / mu0, b = 1/2 of isotropic scattering.
  const std::vector<double> mu = {1, 0.01};
  const auto fluxes = plane_parallel_fluxes(isotropic_moment, mu, 1e-8, 0.7);
  for (std::size_t i = 0; i < mu.size(); ++i) {
    const double scattered = 0.7 * 1e-8 / mu[i];
    EXPECT_NEAR(fluxes[i].reflectance / scattered, 0.5, 1e-5);
    EXPECT_NEAR((1 - fluxes[i].transmittance) / scattered, 1 / 0.7 - 0.5, 1e-5);
  }
}

TEST(PlaneParallel, SurfaceReflectsThroughAnAbsorber) {
  // The reflected light is A T(mu0) 2 E3(tau): 2 E3(1) = .2193839 (Abramowitz & Stegun, table 5.1).
  const std::vector<double> mu = {0.5};
  const auto fluxes = plane_parallel_fluxes(isotropic_moment, mu, 1, 0, 0.3);
  EXPECT_NEAR(fluxes[0].reflectance, 0.3 * std::exp(-2) * 0.2193839, 1e-7);
  EXPECT_NEAR(fluxes[0].transmittance, std::exp(-2), rounding);
}

TEST(PlaneParallel, DeepIsotropicSlabHasTheAlbedoOfChandrasekhar) {
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

// A uniform sky over matter that absorbs nothing and white ground: radiance is the sky's everywhere.
TEST(PlaneParallel, FurnaceHasTheSkysRadiance) {
  PlaneParallelScene scene;
  scene.layers = {{3, 1, henyey_greenstein_moment}, {0.5, 1, rayleigh_moment}};
  scene.surface_albedo = 1;
  scene.irradiance = 0;
  scene.sky_radiance = 1;
  PlaneParallelEffort effort;
  effort.angles = 24;
  effort.slices = 2;
  effort.view_mu = {0.2, 1};
  effort.view_azimuth_deg = {0, 90};
  const PlaneParallelSolution solution = solve_plane_parallel(scene, effort);
  ASSERT_EQ(solution.levels.size(), 5u);
  for (const PlaneParallelLevel& level : solution.levels) {
    EXPECT_NEAR(level.up, std::numbers::pi, 1e-8);
    EXPECT_NEAR(level.down_diffuse, std::numbers::pi, 1e-8);
  }
  EXPECT_LT((solution.radiance_up_top.array() - 1).abs().maxCoeff(), 1e-8);
  EXPECT_LT((solution.radiance_down_bottom.array() - 1).abs().maxCoeff(), 1e-8);
}

// Neither the position of a cut of a layer nor slices change anything.
TEST(PlaneParallel, CutsChangeNothing) {
  PlaneParallelScene whole, cut;
  whole.layers = {{2, 0.95, henyey_greenstein_moment}};
  cut.layers = {{0.5, 0.95, henyey_greenstein_moment}, {1.5, 0.95, henyey_greenstein_moment}};
  whole.sun_mu = cut.sun_mu = 0.4;
  whole.surface_albedo = cut.surface_albedo = 0.3;
  PlaneParallelEffort one, four;
  one.angles = four.angles = 24;
  four.slices = 4;
  const auto a = solve_plane_parallel(whole, four).levels, b = solve_plane_parallel(cut, one).levels;
  for (const auto& [slice, layer] : {std::pair(0, 0), std::pair(1, 1), std::pair(4, 2)}) {
    EXPECT_NEAR(a[slice].optical_depth, b[layer].optical_depth, 1e-14);
    // Second order in first slabs of 2/4096 to 2/8192.
    EXPECT_NEAR(a[slice].up, b[layer].up, 1e-7);
    EXPECT_NEAR(a[slice].down_diffuse, b[layer].down_diffuse, 1e-7);
  }
}

// cdisort 2.1.3 with 128 streams, as in tests/data/plane_parallel_subset.json: depth 1, conservative, mu0 .5, unit flux
// facing the sun. Azimuth of travel, 0 for the beam's; mu < 0: down at the bottom. Its own error is some 1e-5.
TEST(PlaneParallel, RadiancesAreThoseOfDiscreteOrdinates) {
  struct Value {
    double mu, azimuth, radiance;
  };
  struct Case {
    Moments moments;
    double surface_albedo;
    std::vector<Value> values;
  };
  for (const Case& c :
       {Case{henyey_greenstein_moment,
             0.2,
             {{0.5, 0, 0.1024679464},
              {0.5, 180, 0.03480114927},
              {1, 0, 0.03488821984},
              {-0.3, 90, 0.05426877821},
              {-0.7, 180, 0.01556314042}}},
        Case{
            rayleigh_moment,
            0,
            {{0.5, 0, 0.0878238031}, {0.5, 90, 0.08169623666}, {0.5, 180, 0.1107691585}, {-0.5, 90, 0.06025518414}}}}) {
    PlaneParallelScene scene;
    scene.layers = {{1, 1, c.moments}};
    scene.surface_albedo = c.surface_albedo;
    scene.sun_mu = 0.5;
    PlaneParallelEffort effort;
    effort.angles = 40;
    for (const Value& value : c.values) {
      effort.view_mu = {std::abs(value.mu)};
      effort.view_azimuth_deg = {value.azimuth};
      const PlaneParallelSolution solution = solve_plane_parallel(scene, effort);
      const double found = (value.mu > 0 ? solution.radiance_up_top : solution.radiance_down_bottom)(0, 0);
      EXPECT_NEAR(found / value.radiance, 1, 1e-4) << value.mu << " " << value.azimuth;
    }
  }
}

}  // namespace
}  // namespace cloudbow::reference
