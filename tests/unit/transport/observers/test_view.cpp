// Images along parallel lines of sight. Truth: closed forms of single scattering and of bare ground.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cloudbow/medium/cloud_makers.hpp"
#include "cloudbow/sphere/interpolation_weights.hpp"
#include "cloudbow/transport/solver.hpp"
#include "solve_test_tools.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

TEST(Solve, ViewsThroughAbsorbersFollowBeer) {
  // Nothing scatters: light goes down through tau, comes off the ground and goes up through tau; from below the sky
  // alone.
  const double tau = .7, mu0 = .6, mu = .5, albedo = .3, sky = 2;
  Problem problem = slab(tau, 0, PhaseFunction::isotropic(), mu0);
  problem.surface.albedo = albedo;
  problem.sky_radiance = sky;
  SolverOptions options = coarse();
  options.views = {{"up", travel_along(mu, 10)}, {"down", travel_along(-mu, 10)}};
  const Solution solution = solve(problem, options);
  ASSERT_EQ(solution.images.size(), 2U);
  const double ground = solution.upwelling_flux[0] / pi;
  EXPECT_GT(ground, albedo / pi * mu0 * std::exp(-tau / mu0));  // and the light of the sky
  EXPECT_NEAR(solution.images[0].radiance[0], ground * std::exp(-tau / mu), 2e-6 * ground);
  EXPECT_NEAR(solution.images[1].radiance[0], sky * std::exp(-tau / mu), 1e-5);
}

TEST(Solve, ViewsOfThinAirAreSingleScattering) {
  // I = P F0 mu0/(mu + mu0) [1 - e^(-tau (1/mu + 1/mu0))] / (4 pi) for light that comes up; higher orders are smaller
  // by about tau. Ahead of the sun and behind it the radiances differ by a factor of 7.6: an azimuth that flips cannot
  // pass.
  const double tau = 1e-4, mu0 = .5, mu = .5;
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(.8);
  Problem problem = slab(tau, 1, phase, mu0);  // the sun's light travels in azimuth 37
  SolverOptions options = coarse();
  options.views = {{"ahead", travel_along(mu, 37)}, {"behind", travel_along(mu, 217)}};
  const Solution solution = solve(problem, options);
  const double path = (1 - std::exp(-tau * (1 / mu + 1 / mu0))) * mu0 / (mu + mu0) / (4 * pi);
  for (std::size_t v = 0; v < 2; ++v) {
    const double cosine = -mu * mu0 + (v == 0 ? 1 : -1) * .75;
    EXPECT_NEAR(solution.images[v].radiance[0] / (phase(cosine) * path), 1, 2e-3);
  }
  EXPECT_GT(solution.images[0].radiance[0], 7 * solution.images[1].radiance[0]);
}

TEST(Solve, ViewsOfBareGroundAreItsReflectance) {
  // Air of tau 1e-8: the images show f mu0 F0.
  Problem problem = slab(1e-8, 1, PhaseFunction::isotropic(), .6);
  const SurfaceBrdf brdf = SurfaceBrdf::rpv(.1, .7, -.24, .1);
  problem.surface.brdf = brdf;
  SolverOptions options = coarse();
  for (const double azimuth : {37., 100., 217.}) options.views.push_back({"v", travel_along(.4, azimuth)});
  const Solution solution = solve(problem, options);
  for (const RadianceImage& image : solution.images)
    EXPECT_NEAR(image.radiance[0] / (.6 * brdf(problem.sun->travel, image.view.travel)), 1, 1e-5);
}

}  // namespace
}  // namespace cloudbow
