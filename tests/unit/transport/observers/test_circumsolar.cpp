// Circumsolar light. Truth: closed forms of single scattering, of an absorber under an even sky and of a shadow.
// Other truths: adding and doubling, and independent columns.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "cloudbow/sphere/gauss_legendre.hpp"
#include "cloudbow/transport/solver.hpp"
#include "reference/plane_parallel.hpp"
#include "solve_test_tools.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;
constexpr double degree = pi / 180;

SolverOptions with_cone(double half_angle_deg) {
  SolverOptions options = coarse();
  options.circumsolar_half_angle = half_angle_deg * degree;
  return options;
}

// Integral of a function of the angle from the sun, times the cosine, over the cone.
double over_cone(double half_angle, const std::function<double(double)>& radiance) {
  const GaussLegendre rule = make_gauss_legendre(24);
  double sum = 0;
  for (std::size_t n = 0; n < rule.node.size(); ++n) {
    const double angle = half_angle * .5 * (1 + rule.node[n]);
    sum += rule.weight[n] * .5 * half_angle * 2 * pi * std::sin(angle) * std::cos(angle) * radiance(angle);
  }
  return sum;
}

TEST(Circumsolar, ThinAirScattersOnce) {
  // I = P F0 tau / (4 pi mu). The mean of 1/mu over the azimuths at the angle a is 1/sqrt(cos^2 a - sin^2 z). The sun
  // stands at the zenith angle z. Scattering twice and attenuation are smaller by tau/mu0.
  const double tau = 1e-5, mu0 = .6;
  for (const double g : {.85, .98}) {
    const PhaseFunction phase = PhaseFunction::henyey_greenstein(g);
    for (const double half_deg : {.5, 3., 10.}) {
      const Solution solution = solve(slab(tau, .9, phase, mu0), with_cone(half_deg));
      const double expected = over_cone(half_deg * degree, [&](double angle) {
        const double path = tau / std::sqrt(std::pow(std::cos(angle), 2) - 1 + mu0 * mu0);
        return .9 * phase(std::cos(angle)) * path / (4 * pi);
      });
      ASSERT_EQ(solution.circumsolar_flux.size(), 2U);
      // One angle and six azimuths stand for a ring. Across the widest, 1/mu varies by half: measured 1.4e-3.
      EXPECT_NEAR(solution.circumsolar_flux[0] / expected, 1, 2e-3) << g << ' ' << half_deg;
      EXPECT_EQ(solution.circumsolar_flux[1], 0);
    }
  }
}

TEST(Circumsolar, AnAbsorberDimsTheSky) {
  // An even sky alone: at the top pi sin^2 of its radiance, below that times exp(-tau/mu).
  const double tau = .8, mu0 = 1, sky = 2, half = 4 * degree;
  Problem problem = slab(tau, 0, PhaseFunction::isotropic(), mu0);
  problem.sky_radiance = sky;
  const Solution solution = solve(problem, with_cone(4));
  const double expected = over_cone(half, [&](double angle) { return sky * std::exp(-tau / std::cos(angle)); });
  // One angle for each ring, of a function whose curvature is tau times a squared angle
  EXPECT_NEAR(solution.circumsolar_flux[0] / expected, 1, 1e-5);
  EXPECT_NEAR(solution.circumsolar_flux[1] / (sky * pi * std::pow(std::sin(half), 2)), 1, 1e-6);
}

TEST(Circumsolar, SlabsAgreeWithAddingAndDoubling) {
  // The sun at the zenith: radiances depend on one angle alone. HG .85 is resolved by 96 moments to 1e-7.
  const double g = .85, half = 3 * degree;
  const GaussLegendre rule = make_gauss_legendre(8);
  for (const double tau : {.3, 1., 4., 10.}) {
    reference::PlaneParallelScene scene;
    scene.layers = {{tau, 1, [g](int l) { return std::pow(g, l); }}};
    reference::PlaneParallelEffort effort;
    for (const double node : rule.node) effort.view_mu.push_back(std::cos(half * .5 * (1 + node)));
    effort.view_azimuth_deg = {0};
    const reference::PlaneParallelSolution truth = solve_plane_parallel(scene, effort);
    double expected = 0;
    for (std::size_t n = 0; n < rule.node.size(); ++n) {
      const double angle = half * .5 * (1 + rule.node[n]);
      expected += rule.weight[n] * .5 * half * 2 * pi * std::sin(angle) * std::cos(angle) *
                  truth.radiance_down_bottom(static_cast<Eigen::Index>(n), 0);
    }
    SolverOptions options = with_cone(3);
    options.directions = "double-gauss-8x16";
    options.fit.delta_m_order = 8;
    options.fit.beam_delta_m_order = 12;
    options.control_points = 162;
    const Solution solution = solve(slab(tau, 1, PhaseFunction::henyey_greenstein(g), 1), options);
    // Measured .1 to .8 %: the light beside the peak is known from one direction.
    EXPECT_NEAR(solution.circumsolar_flux[0] / expected, 1, 1e-2) << tau;
  }
}

TEST(Circumsolar, LightOfASmallCloudFallsAboutItsShadow) {
  // One thin cell, 20 m above the ground, scatters tau F0 of its area. The sun is at the zenith. So the light falls
  // within 20 m tan 10 degrees = 3.5 m of the shadow. Half cells of the cloud and of a column are added.
  const double tau = 1e-4, half = 10 * degree;
  const BoxGrid box = make_box(16, 16, 21);
  std::vector<float> extinction(cells_of(box), 0.F);
  extinction[(20 * 16 + 8) * 16 + 8] = static_cast<float>(tau);
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(.85);
  const Problem problem = problem_of(make_grid(box, extinction, 1), phase, 1);
  const Solution solution = solve(problem, with_cone(10));
  double sum = 0, beside = 0;
  for (int j = 0; j < 16; ++j) {
    for (int i = 0; i < 16; ++i) {
      const double here = static_cast<double>(solution.circumsolar_flux[j * 16 + i]);
      sum += here;
      if (std::max(std::abs(i - 8), std::abs(j - 8)) > 5) beside += here;
    }
  }
  const double expected =
      over_cone(half, [&](double angle) { return phase(std::cos(angle)) * tau / std::cos(angle) / (4 * pi); });
  EXPECT_NEAR(sum / expected, 1, 2e-3);  // 1/mu at one angle for each ring
  EXPECT_LT(beside, 1e-6 * sum);
  EXPECT_GT(sum, 2 * static_cast<double>(solution.circumsolar_flux[8 * 16 + 8]));  // it is spread
}

TEST(Circumsolar, LevelsAndThreadsDoNotChangeIt) {
  const Problem problem = random_problem(true, 1, .99, .3);
  SolverOptions options = with_cone(3);
  options.flux_levels = FluxLevels::all;
  options.threads = 1;
  const Solution all = solve(problem, options);
  options.flux_levels = FluxLevels::boundaries;
  options.threads = 3;
  const Solution ends = solve(problem, options);
  const std::size_t columns = problem.grid.box.columns();
  ASSERT_EQ(all.circumsolar_flux.size(), 5 * columns);
  ASSERT_EQ(ends.circumsolar_flux.size(), 2 * columns);
  for (std::size_t c = 0; c < columns; ++c) {
    EXPECT_EQ(ends.circumsolar_flux[c], all.circumsolar_flux[c]);
    EXPECT_EQ(ends.circumsolar_flux[columns + c], all.circumsolar_flux[4 * columns + c]);
  }
}

TEST(Circumsolar, IndependentColumnsAreColumnsOfTheirOwn) {
  // Each column of a field is the slab of its extinction.
  BoxGrid box = make_box(2, 1, 4);
  std::vector<float> extinction(cells_of(box));
  for (std::size_t c = 0; c < extinction.size(); ++c) extinction[c] = c % 2 == 0 ? .1F : .4F;
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(.85);
  SolverOptions options = with_cone(3);
  options.independent_columns = true;
  const Solution both = solve(problem_of(make_grid(box, extinction, 1), phase), options);
  box.nx = 1;
  for (std::size_t column = 0; column < 2; ++column) {
    const std::vector<float> own(4, column == 0 ? .1F : .4F);
    const Solution alone = solve(problem_of(make_grid(box, own, 1), phase), options);
    EXPECT_NEAR(both.circumsolar_flux[column] / alone.circumsolar_flux[0], 1, 1e-5);  // float
  }
}

TEST(Circumsolar, LayersShineThroughOpenSides) {
  // Thin haze with a peak, and a box with open sides that contains nothing else: as if it had no sides.
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(.9);
  BoxGrid box = make_box(4, 4, 5);
  Problem problem = problem_of(make_grid(box, std::vector<float>(cells_of(box), .02F), 1), phase);
  const Solution closed = solve(problem, with_cone(5));
  problem.grid.box.periodic = false;
  problem.grid.layer_scattering = {std::vector<double>(5, .02)};
  const Solution open = solve(problem, with_cone(5));
  for (std::size_t c = 0; c < box.columns(); ++c) {
    // The layers outside are solved as one column, with other slopes of the source.
    EXPECT_NEAR(open.circumsolar_flux[c] / closed.circumsolar_flux[c], 1, 1e-2);
  }
}

TEST(Circumsolar, WithoutSunThereIsNone) {
  Problem problem = slab(1, 1, PhaseFunction::isotropic(), .5);
  problem.sun.reset();
  problem.sky_radiance = 1;
  const Solution solution = solve(problem, with_cone(3));
  EXPECT_EQ(solution.circumsolar_flux, (std::vector<float>{0, 0}));
}

}  // namespace
}  // namespace cloudbow
