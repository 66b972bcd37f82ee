// Images of cameras. Truth: parallel views, and closed forms of single scattering.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "cloudbow/medium/cloud_makers.hpp"
#include "cloudbow/sphere/interpolation_weights.hpp"
#include "cloudbow/transport/solver.hpp"
#include "solve_test_tools.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

TEST(Solve, FarCamerasAndGridsOfPixelsSeeWhatParallelViewsSee) {
  // A telescope of a milliradian in line with the view; a grid of one pixel a column. Lines of sight differ in place by
  // parts of a column alone, in direction by less than a thousandth.
  Problem problem = random_problem(true, .3, .99, .3);
  problem.surface.albedo = .3;
  const BoxGrid& box = problem.grid.box;
  SolverOptions options = coarse();
  options.beam_rays = 64;
  const Direction travel = travel_along(.7, 100);
  options.views = {{"columns", travel}, {"pixels", travel, box.nx, box.ny}, {"below", travel_along(-.5, 10)}};
  const double width = box.nx * box.dx_m, height = box.ny * box.dy_m;
  const Eigen::Vector3d centre(box.x_min_m + width / 2, box.y_min_m + height / 2, box.z_edge_m.back());
  const double far = 2e3 * std::max(width, height);
  options.cameras = {make_camera("far", Camera::Projection::perspective, {centre + far * travel, centre},
                                 2 * std::atan(width / 2 / far), 40, 40)};
  const Solution solution = solve(problem, options);
  const auto mean = [](const std::vector<float>& image) {
    return std::accumulate(image.begin(), image.end(), 0.) / static_cast<double>(image.size());
  };
  const auto& columns = solution.images[0].radiance;
  const auto& pixels = solution.images[1].radiance;
  ASSERT_EQ(columns.size(), pixels.size());
  for (std::size_t c = 0; c < columns.size(); ++c) EXPECT_NEAR(pixels[c], columns[c], .02 * columns[c]);
  EXPECT_NEAR(mean(pixels) / mean(columns), 1, 2e-3);
  // The camera looks at a square of one domain's width, foreshortened: a domain's mean, whole in x and nearly so in y.
  // Its source is interpolated between points.
  EXPECT_NEAR(mean(solution.camera_images[0].radiance) / mean(columns), 1, .03);
}

TEST(Solve, CamerasInThinAirSeeSingleScatteringAndTheGround) {
  const double tau = 1e-4, mu0 = .5;
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(.8);
  Problem problem = slab(tau, 1, phase, mu0);
  problem.surface.albedo = .2;
  SolverOptions options = coarse();
  const double top = problem.grid.box.z_edge_m.back();
  // One pixel of a hundredth of a degree, from the ground upwards and from above downwards.
  for (const double mu : {.8, -.8}) {
    const Direction line = travel_along(mu, 80);
    const Eigen::Vector3d eye(0, 0, mu > 0 ? 0 : top);
    options.cameras.push_back(make_camera("c", Camera::Projection::perspective, {eye, eye + 10 * line}, 1.7e-4, 1, 1));
  }
  const Solution solution = solve(problem, options);
  const double cosine = -travel_along(.8, 80).dot(problem.sun->travel);
  const double path = (std::exp(-tau / .8) - std::exp(-tau / mu0)) * mu0 / (.8 - mu0) / (4 * pi);
  const double sky = phase(cosine) * path;
  // Light from the ground scatters too: some .2 mu0 of the sun's, by the phase function's values about its mean, not
  // its 3 % here.
  EXPECT_NEAR(solution.camera_images[0].radiance[0] / sky, 1, .3);
  EXPECT_GT(solution.camera_images[0].radiance[0], sky);
  EXPECT_NEAR(solution.camera_images[1].radiance[0] / (.2 * mu0 / pi), 1, 1e-3);
}

}  // namespace
}  // namespace cloudbow
