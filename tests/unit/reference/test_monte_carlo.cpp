// The Monte Carlo reference, itself tested: against closed forms, doubling, and tables that discrete ordinates made.
// Tolerances are four or five standard errors: the seeds are fixed, so a test that passes passes always.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "../near_with_report.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"
#include "reference/monte_carlo.hpp"
#include "reference/plane_parallel.hpp"

namespace cloudbow::reference {
namespace {

using std::numbers::pi;

double degrees(double cosine) { return std::acos(cosine) * 180 / pi; }

/// A slab of 500 m in layers of different height, as 4 x 3 columns. The extinction of one cell differs negligibly, so
/// that photons cross cells instead of one uniform layer.
MonteCarloScene slab(double optical_depth, double ssa, const Scatterer& scatterer, double mu0) {
  MonteCarloScene scene;
  scene.columns = {4, 3};
  scene.column_size_m = {100, 70};
  scene.z_edge_m = {0, 50, 150, 500};
  scene.sun_zenith_deg = degrees(mu0);
  scene.sun_azimuth_deg = 25;
  scene.levels = {0, 1, 2, 3};
  scene.absorption = true;
  scene.media = {{ssa, scatterer, std::vector<double>(36, optical_depth / 500)}};
  for (int k = 0; k < 3; ++k) scene.media[0].extinction[12 * k + 5] *= 1 + 1e-9;
  return scene;
}

double total_absorbed(const MonteCarloResult& result) {
  double sum = 0;
  for (const Plane& plane : result.absorbed) sum += plane.mean;
  return sum;
}

void expect_within(double found, double expected, double standard_error, double known_error = 0) {
  EXPECT_NEAR(found, expected, 4.5 * standard_error + known_error);
}

std::vector<double> angles_of_table() {
  std::vector<double> angle(1801);
  for (int n = 0; n <= 1800; ++n) angle[n] = n * 0.1;
  return angle;
}

Scatterer tabulated(const Scatterer& scatterer) {
  const auto angle = angles_of_table();
  std::vector<double> value;
  for (const double a : angle) value.push_back(3 * scatterer(std::cos(a * pi / 180)));
  return Scatterer::table(angle, value);
}

TEST(Scatterer, DrawsHaveTheMomentsOfHenyeyAndGreenstein) {
  // The mean of P_l over evenly spread quantiles is chi_l = g^l: the integral over the inverse distribution.
  for (const double g : {0.85, -0.4, 0.1}) {
    const auto scatterer = Scatterer::henyey_greenstein(g);
    constexpr int n = 100000;
    double first = 0, second = 0;
    for (int i = 0; i < n; ++i) {
      const double mu = scatterer.cosine_at((i + 0.5) / n);
      first += mu / n;
      second += (1.5 * mu * mu - 0.5) / n;
    }
    EXPECT_NEAR(first, g, 1e-6);
    EXPECT_NEAR(second, g * g, 1e-6);
  }
}

TEST(Scatterer, DrawsAreTheInverseOfTheDensitysIntegral) {
  const auto hg = Scatterer::henyey_greenstein(0.85);
  const GaussLegendre rule = make_gauss_legendre(200);
  for (const Scatterer& s : {Scatterer::isotropic(), Scatterer::rayleigh(), hg}) {
    for (const double u : {0.01, 0.3, 0.5, 0.9}) {
      const double mu = s.cosine_at(u);
      double share = 0;
      for (std::size_t n = 0; n < rule.node.size(); ++n) {
        share += rule.weight[n] * (mu + 1) / 4 * s((mu + 1) / 2 * rule.node[n] + (mu - 1) / 2);
      }
      EXPECT_NEAR(share, u, 1e-10) << mu;
    }
  }
}

TEST(Scatterer, TableOfManyAnglesIsTheFunction) {
  const auto exact = Scatterer::henyey_greenstein(0.85), table = tabulated(exact);
  for (const double u : {1e-4, 0.2, 0.5, 0.8, 0.999}) EXPECT_NEAR(table.cosine_at(u), exact.cosine_at(u), 2e-5);
  for (const double mu : {-1.0, -0.3, 0.5, 0.999, 1.0}) EXPECT_NEAR(table(mu) / exact(mu), 1, 1e-4);
  EXPECT_EQ(table.cosine_at(0), -1);
  EXPECT_NEAR(table.cosine_at(1), 1, 1e-12);
}

TEST(MonteCarlo, AbsorberObeysBeerAtEveryLevel) {
  const double mu0 = 0.6, tau = 1.5;
  const auto result = solve_by_monte_carlo(slab(tau, 0, Scatterer::isotropic(), mu0), {200000, 50, 3, 1});
  const double above[] = {tau, tau * 0.9, tau * 0.7, 0};
  for (int level = 0; level < 4; ++level) {
    expect_within(result.down[level].mean, std::exp(-above[level] / mu0), result.down[level].mean_standard_error,
                  1e-6);  // the slightly different cell, and places that follow a sequence
    EXPECT_EQ(result.up[level].mean, 0);
  }
  EXPECT_NEAR(total_absorbed(result) + result.down[0].mean, 1, 1e-12);  // nothing scatters, so nothing is drawn for it
}

TEST(MonteCarlo, SlabsAgreeWithDoubling) {
  struct Case {
    double g, tau, ssa;
  };
  for (const Case& c : {Case{0, 1, 1}, Case{0.85, 5, 1}, Case{0.85, 5, 0.9}}) {
    for (const double mu0 : {1.0, 0.5}) {
      const std::vector<double> beam = {mu0};
      const auto expected = plane_parallel_fluxes([&](int l) { return std::pow(c.g, l); }, beam, c.tau, c.ssa)[0];
      const auto result =
          solve_by_monte_carlo(slab(c.tau, c.ssa, Scatterer::henyey_greenstein(c.g), mu0), {80000, 40, 7, 1});
      expect_within(result.up[3].mean, expected.reflectance, result.up[3].mean_standard_error);
      expect_within(result.down[0].mean, expected.transmittance, result.down[0].mean_standard_error);
    }
  }
}

TEST(MonteCarlo, LedgerOfPowerCloses) {
  auto scene = slab(3, 0.9, Scatterer::henyey_greenstein(0.7), 0.5);
  scene.surface_albedo = 0.4;
  const auto result = solve_by_monte_carlo(scene, {100000, 50, 5, 1});
  // Roulette keeps power on average only.
  const double all = result.up[3].mean + 0.6 * result.down[0].mean + total_absorbed(result);
  EXPECT_NEAR(all, 1, 2e-3);
  // Between two levels: incoming less outgoing power is the power that the layer absorbed; the weights are the same.
  for (int k = 1; k < 3; ++k) {
    const double net_in = result.down[k + 1].mean - result.up[k + 1].mean - result.down[k].mean + result.up[k].mean;
    EXPECT_NEAR(net_in, result.absorbed[k].mean, 2e-3);
  }
  scene.media[0].single_scattering_albedo = 1;
  scene.surface_albedo = 0;
  const auto conservative = solve_by_monte_carlo(scene, {50000, 10, 5, 1});
  EXPECT_NEAR(conservative.up[3].mean + conservative.down[0].mean, 1, 1e-12);
}

TEST(MonteCarlo, SurfaceUnderClearAirShinesEqually) {
  // A Lambertian surface of albedo A under unit flux has the radiance A/pi everywhere.
  MonteCarloScene scene;
  scene.columns = {2, 2};
  scene.column_size_m = {10, 10};
  scene.z_edge_m = {0, 5, 30};
  scene.sun_zenith_deg = 40;
  scene.surface_albedo = 0.3;
  scene.levels = {0, 2};
  scene.views = {{0, 0}, {60, 130}, {120, 0}};
  scene.media = {{1, Scatterer::isotropic(), std::vector<double>(8, 0.0)}};
  const auto result = solve_by_monte_carlo(scene, {100000, 50, 2, 1});
  EXPECT_NEAR(result.down[1].mean, 1, 1e-12);
  EXPECT_NEAR(result.radiance[0].mean, 0.3 / pi, 1e-12);  // above the least contribution: no roulette, no noise
  expect_within(result.radiance[1].mean, 0.3 / pi, result.radiance[1].mean_standard_error, 1e-12);
  EXPECT_EQ(result.radiance[2].mean, 0);
  EXPECT_NEAR(result.up[0].mean, 0.3, 1e-12);
  EXPECT_NEAR(result.up[1].mean, 0.3, 1e-12);
}

TEST(MonteCarlo, ConeAboutTheSunCountsDiffuseLightAlone) {
  // An even sky of radiance 1 sends pi sin^2 of the half angle through a plane that faces the sun. The sun's own light
  // is not counted, that from below neither.
  MonteCarloScene scene;
  scene.columns = {2, 1};
  scene.column_size_m = {10, 10};
  scene.z_edge_m = {0, 5, 30};
  scene.sun_zenith_deg = 30;
  scene.surface_albedo = 1;
  scene.levels = {0, 1};
  scene.circumsolar_deg = 40;
  scene.media = {{1, Scatterer::isotropic(), std::vector<double>(4, 0.0)}};
  const auto of_sun = solve_by_monte_carlo(scene, {1000, 10, 2, 1});
  EXPECT_EQ(of_sun.circumsolar[0].mean, 0);
  scene.sky_radiance = 1;
  const auto result = solve_by_monte_carlo(scene, {200000, 50, 3, 1});
  const double expected = pi * std::pow(std::sin(40 * pi / 180), 2);
  for (const Plane& plane : result.circumsolar) {
    expect_within(plane.mean, expected, plane.mean_standard_error);
    EXPECT_LT(plane.mean_standard_error, .01 * expected);  // so that agreement means something
  }
}

TEST(MonteCarlo, RadiancesAreThoseOfDiscreteOrdinates) {
  // cdisort 2.1.3 with 128 streams, as in tests/data/plane_parallel_subset.json, for unit flux facing the sun at mu0
  // .5; the azimuth is that of the light's travel, 0 for the beam's. Depth 1, conservative.
  struct Value {
    double mu, azimuth, radiance;  // mu < 0: down at the bottom
  };
  struct Case {
    Scatterer scatterer;
    double surface_albedo;
    std::vector<Value> values;
  };
  const auto hg = Scatterer::henyey_greenstein(0.85);
  const std::vector<Value> of_hg = {{0.5, 0, 0.1024679464},
                                    {0.5, 180, 0.03480114927},
                                    {1, 0, 0.03488821984},
                                    {-0.3, 90, 0.05426877821},
                                    {-0.7, 180, 0.01556314042}};
  const std::vector<Value> of_rayleigh = {
      {0.5, 0, 0.0878238031}, {0.5, 90, 0.08169623666}, {0.5, 180, 0.1107691585}, {-0.5, 90, 0.06025518414}};
  for (const Case& c :
       {Case{hg, 0.2, of_hg}, Case{tabulated(hg), 0.2, of_hg}, Case{Scatterer::rayleigh(), 0, of_rayleigh}}) {
    auto scene = slab(1, 1, c.scatterer, 0.5);
    scene.sun_azimuth_deg = 180;
    scene.surface_albedo = c.surface_albedo;
    for (const Value& v : c.values) scene.views.push_back({degrees(v.mu), v.azimuth});
    const auto result = solve_by_monte_carlo(scene, {100000, 50, 4, 1});
    for (std::size_t n = 0; n < c.values.size(); ++n) {
      const Plane& found = result.radiance[n];
      expect_within(found.mean, c.values[n].radiance / 0.5, found.mean_standard_error);
      EXPECT_LT(found.mean_standard_error, 0.03 * found.mean);  // so that agreement means something
    }
  }
}

TEST(MonteCarlo, TwoMediaActAsTheirMixture) {
  // Half of the extinction absorbs only: the same as one medium of half the albedo.
  auto scene = slab(2, 1, Scatterer::henyey_greenstein(0.5), 0.8), mixture = scene;
  scene.media.push_back({0, Scatterer::isotropic(), scene.media[0].extinction});
  for (double& e : mixture.media[0].extinction) e *= 2;
  mixture.media[0].single_scattering_albedo = 0.5;
  const auto two = solve_by_monte_carlo(scene, {200000, 50, 2, 1}),
             one = solve_by_monte_carlo(mixture, {200000, 50, 9, 1});
  const auto error = [](const Plane& a, const Plane& b) {
    return std::hypot(a.mean_standard_error, b.mean_standard_error);
  };
  expect_within(two.up[3].mean, one.up[3].mean, error(two.up[3], one.up[3]));
  expect_within(two.down[0].mean, one.down[0].mean, error(two.down[0], one.down[0]));
}

TEST(MonteCarlo, SunCastsTheShadowOfAnAbsorberWhereItBelongs) {
  // A black cell one column wide, directly on the surface; the sun at azimuth 0 under 45 degrees throws its shadow
  // towards -x, a cell long: the light that meets it is lost from its own column and from the next one at x - 1.
  MonteCarloScene scene;
  scene.columns = {5, 1};
  scene.column_size_m = {10, 10};
  scene.z_edge_m = {0, 10, 20};
  scene.sun_zenith_deg = 45;
  scene.levels = {0};
  scene.media = {{0, Scatterer::isotropic(), std::vector<double>(10, 0.0)}};
  scene.media[0].extinction[2] = 1e3;
  for (const bool open : {false, true}) {
    scene.open_sides = open;
    const auto result = solve_by_monte_carlo(scene, {100000, 10, 2, 1});
    const double expected[] = {1, 0, 0, 1, 1};
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(result.down[0].value[i], expected[i], 2e-2) << i;  // the cell is not opaque
  }
}

TEST(MonteCarlo, OpenSidesLetLightOut) {
  // The fluxes up and down through the ends and the loss at the sides sum to the incident flux: less than in the
  // periodic box.
  auto scene = slab(4, 1, Scatterer::henyey_greenstein(0.5), 1);
  const auto periodic = solve_by_monte_carlo(scene, {50000, 10, 2, 1});
  scene.open_sides = true;
  const auto open = solve_by_monte_carlo(scene, {50000, 10, 2, 1});
  EXPECT_LT(open.up[3].mean, 0.8 * periodic.up[3].mean);
  EXPECT_NEAR(open.down[3].mean, 1, 1e-12);
}

TEST(MonteCarlo, ThreadsDoNotChangeTheResult) {
  const auto scene = slab(4, 0.99, Scatterer::henyey_greenstein(0.85), 0.5);
  const auto one = solve_by_monte_carlo(scene, {20000, 10, 2, 1}),
             three = solve_by_monte_carlo(scene, {20000, 10, 2, 3});
  EXPECT_EQ(one.up[3].value, three.up[3].value);
  EXPECT_EQ(one.down[1].standard_error, three.down[1].standard_error);
  const auto other = solve_by_monte_carlo(scene, {20000, 10, 3, 1});
  EXPECT_NE(one.up[3].value, other.up[3].value);
}

}  // namespace
}  // namespace cloudbow::reference
