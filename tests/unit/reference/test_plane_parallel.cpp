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

// Kirchhoff: matter, ground and sky of one temperature have its Planck radiance everywhere.
TEST(PlaneParallel, EnclosureHasThePlanckRadianceEverywhere) {
  for (const double ssa : {0.0, 0.7, 0.999}) {
    PlaneParallelScene scene;
    scene.layers = {{3, ssa, henyey_greenstein_moment, 2, 2}, {0.01, 0.3, rayleigh_moment, 2, 2}};
    scene.surface_albedo = 0.4;
    scene.irradiance = 0;
    scene.sky_radiance = scene.surface_planck = 2;
    PlaneParallelEffort effort;
    effort.angles = 24;
    effort.slices = 2;
    effort.view_mu = {0.2, 1};
    effort.view_azimuth_deg = {0};
    const PlaneParallelSolution solution = solve_plane_parallel(scene, effort);
    for (const PlaneParallelLevel& level : solution.levels) {
      EXPECT_NEAR(level.up / (2 * std::numbers::pi), 1, 1e-10);
      EXPECT_NEAR(level.down_diffuse / (2 * std::numbers::pi), 1, 1e-10);
    }
    EXPECT_LT((solution.radiance_up_top.array() / 2 - 1).abs().maxCoeff(), 1e-10);
    EXPECT_LT((solution.radiance_down_bottom.array() / 2 - 1).abs().maxCoeff(), 1e-10);
  }
}

TEST(PlaneParallel, AbsorberEmitsAsExponentialIntegralsSay) {
  // Isothermal: flux pi B (1 - 2 E3(tau)), radiance B (1 - exp(-tau/mu)). E3(1) = .1096919 (Abramowitz & Stegun, table
  // 5.1); .10969196719776014 by E3 = (exp(-1) - E2)/2.
  const double e3 = 0.10969196719776014;
  PlaneParallelScene scene;
  scene.layers = {{1, 0, isotropic_moment, 1, 1}};
  scene.irradiance = 0;
  PlaneParallelEffort effort;
  effort.view_mu = {0.3, 1};
  effort.view_azimuth_deg = {0};
  const PlaneParallelSolution solution = solve_plane_parallel(scene, effort);
  // exp(-tau/mu) is integrated by 48 Gauss angles.
  EXPECT_NEAR(solution.levels[0].up / std::numbers::pi, 1 - 2 * e3, 1e-9);
  EXPECT_NEAR(solution.levels[1].down_diffuse / std::numbers::pi, 1 - 2 * e3, 1e-9);
  for (int v = 0; v < 2; ++v) {
    EXPECT_NEAR(solution.radiance_up_top(v, 0), 1 - std::exp(-1 / effort.view_mu[v]), rounding);
    EXPECT_NEAR(solution.radiance_down_bottom(v, 0), 1 - std::exp(-1 / effort.view_mu[v]), rounding);
  }
}

TEST(PlaneParallel, LinearPlanckRadianceLeavesAnAbsorberInClosedForm) {
  // B = 1 + tau in an absorber of depth 4: up I = B(mu) - B(4 + mu) exp(-4/mu), down I = B(4 - mu) - B(-mu) exp(-4/mu).
  PlaneParallelScene scene;
  scene.layers = {{4, 0, isotropic_moment, 1, 5}};
  scene.irradiance = 0;
  PlaneParallelEffort effort;
  effort.angles = 16;
  effort.slices = 3;  // the Planck radiance is linear through them all
  effort.view_mu = {0.2, 0.7, 1};
  effort.view_azimuth_deg = {0};
  const PlaneParallelSolution solution = solve_plane_parallel(scene, effort);
  for (int v = 0; v < 3; ++v) {
    const double mu = effort.view_mu[v], through = std::exp(-4 / mu);
    EXPECT_NEAR(solution.radiance_up_top(v, 0), 1 + mu - (5 + mu) * through, rounding);
    EXPECT_NEAR(solution.radiance_down_bottom(v, 0), 5 - mu - (1 - mu) * through, rounding);
  }
}

// cdisort 2.1.3 with 128 streams: a layer, several layers, and one with the sun. Radiances at the cosines .1 and .7.
TEST(PlaneParallel, EmissionIsThatOfDiscreteOrdinates) {
  struct Case {
    std::vector<PlaneParallelLayer> layers;
    double surface_albedo, surface_planck, sun_mu, irradiance;
    double up, down, radiance_up[2], radiance_down[2];
  };
  const auto hg = [](double g) { return [g](int l) { return std::pow(g, l); }; };
  const std::vector<PlaneParallelLayer> four = {{0.5, 0.1, isotropic_moment, 1, 1.2},
                                                {2, 0.8, hg(0.8), 1.2, 1.5},
                                                {1, 0.3, rayleigh_moment, 1.5, 1.4},
                                                {4, 0.95, hg(0.85), 1.4, 2}};
  for (const Case& c :
       {Case{{{1, 0.5, hg(0.75), 1, 1}},
             0.2,
             1,
             0.5,
             0,
             2.917644558,
             1.885180173,
             {0.8278942283, 0.9372743399},
             {0.9191670658, 0.5662171822}},
        Case{{{5, 0.9, hg(0.85), 0, 1}},
             0,
             0,
             0.5,
             0,
             0.6609541209,
             1.110623066,
             {0.09495951139, 0.2276873744},
             {0.3722114362, 0.3547597213}},
        Case{{{10, 0.99, hg(0.85), 1, 2}},
             0,
             2,
             0.5,
             0,
             3.059492107,
             3.764928741,
             {0.4758654429, 1.008353279},
             {1.637421268, 1.171529191}},
        Case{four, 0.1, 2.2, 0.5, 0, 3.761438861, 5.171692075, {1.006463357, 1.210147421}, {1.915549476, 1.627411549}},
        Case{{{3, 0.9, hg(0.85), 0.1, 0.2}},
             0.2,
             0.25,
             0.6,
             1,
             0.5966951759,
             0.5553290726,
             {0.2452976543, 0.1909597662},
             {0.2593814121, 0.1390126232}}}) {
    PlaneParallelScene scene{c.layers, c.surface_albedo, c.sun_mu, c.irradiance, 0, c.surface_planck};
    PlaneParallelEffort effort;
    effort.angles = 40;
    effort.view_mu = {0.1, 0.7};
    effort.view_azimuth_deg = {0, 90};
    const PlaneParallelSolution solution = solve_plane_parallel(scene, effort);
    // The table is good to 1e-7. In 80 moments the peak of .85 moves radiances of sunlight by 2e-6.
    EXPECT_NEAR(solution.levels.front().up, c.up, 2e-8);
    EXPECT_NEAR(solution.levels.back().down_diffuse, c.down, 2e-8);
    for (int v = 0; v < 2; ++v) {
      const int azimuth = v;  // 0 with the cosine .1, 90 degrees with .7
      EXPECT_NEAR(solution.radiance_up_top(v, azimuth) / c.radiance_up[v], 1, 1e-5);
      EXPECT_NEAR(solution.radiance_down_bottom(v, azimuth) / c.radiance_down[v], 1, 1e-5);
    }
  }
}

/// Radiance of a black body, W m-2 sr-1, between two wavenumbers [1/cm], by quadrature.
double band_radiance(double temperature_k, double low, double high) {
  const double h = 6.62607015e-34, c = 299792458, k = 1.380649e-23;
  const GaussLegendre rule = make_gauss_legendre(64);
  double sum = 0;
  for (std::size_t n = 0; n < rule.node.size(); ++n) {
    const double wavenumber = 100 * (low + (high - low) * (1 + rule.node[n]) / 2);
    sum += rule.weight[n] / 2 * 100 * (high - low) * 2 * h * c * c * wavenumber * wavenumber * wavenumber /
           std::expm1(h * c * wavenumber / (k * temperature_k));
  }
  return sum;
}

// Problem 7a of DISORT's tests (Stamnes et al. 2000): 200 to 300 K over black, cold ground, 300 to 800 cm-1.
TEST(PlaneParallel, EmissionOfABandIsThatOfDisort) {
  PlaneParallelScene scene;
  scene.layers = {
      {1, 0.1, [](int l) { return std::pow(0.05, l); }, band_radiance(200, 300, 800), band_radiance(300, 300, 800)}};
  scene.irradiance = 0;
  const PlaneParallelSolution solution = solve_plane_parallel(scene, {});
  // Printed to seven digits, made with 16 streams and constants of its time.
  EXPECT_NEAR(solution.levels[0].up / 86.2935715, 1, 1e-5);
  EXPECT_NEAR(solution.levels[1].down_diffuse / 121.203537, 1, 1e-5);
}

// Problem 7c: 300 to 200 K over ground of 320 K, the whole spectrum, sun, and a sky of 100 K and a uniform 100 more.
TEST(PlaneParallel, EmissionUnderSunAndSkyIsThatOfDisort) {
  const auto planck = [](double t) { return 5.670374419e-8 * t * t * t * t / std::numbers::pi; };
  PlaneParallelScene scene;
  scene.layers = {{1, 0.5, [](int l) { return std::pow(0.8, l); }, planck(300), planck(200)}};
  scene.sun_mu = 0.5;
  scene.irradiance = 200;
  scene.sky_radiance = planck(100) + 100;
  scene.surface_planck = planck(320);
  const PlaneParallelSolution solution = solve_plane_parallel(scene, {});
  // Made with 12 streams.
  EXPECT_NEAR(solution.levels[0].up / 429.571716, 1, 1e-3);
  EXPECT_NEAR(solution.levels[1].up / 594.576172, 1, 1e-3);
  EXPECT_NEAR(solution.levels[0].down_diffuse / 319.829620, 1, 1e-3);
  EXPECT_NEAR(solution.levels[1].down_diffuse / 301.333710, 1, 1e-3);
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
