// Thermal emission in the Monte Carlo reference, forward and backward: against closed forms, doubling and one another.
// Tolerances are four standard errors: the seeds are fixed, so a test that passes passes always.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "../near_with_report.hpp"
#include "reference/monte_carlo.hpp"
#include "reference/plane_parallel.hpp"

namespace cloudbow::reference {
namespace {

using std::numbers::pi;

void expect_within(double found, double expected, double standard_error, double known_error = 1e-12) {
  EXPECT_NEAR(found, expected, 4 * standard_error + known_error);
}

/// A layer as four layers of cells, 3 x 2 columns. The extinction of one cell differs negligibly, so that photons cross
/// cells instead of one uniform layer.
void add_layer(MonteCarloScene& scene, const PlaneParallelLayer& layer, const Scatterer& scatterer, bool uniform) {
  constexpr int cut = 4, columns = 6;
  constexpr double share[cut] = {0.1, 0.4, 0.3, 0.2};
  const double bottom = scene.z_edge_m.back();
  Medium medium{layer.single_scattering_albedo, scatterer, std::vector<double>(scene.emission.planck.size(), 0.0)};
  double above = 0;
  for (int n = 0; n < cut; ++n) {
    const double step = (layer.planck_top - layer.planck_bottom) * share[n];
    scene.z_edge_m.push_back(scene.z_edge_m.back() + 100 * share[n]);
    for (int c = 0; c < columns; ++c) {
      medium.extinction.push_back(layer.optical_depth / 100 * (c == 2 && !uniform ? 1 + 1e-9 : 1));
      scene.emission.planck.push_back(layer.planck_bottom + (layer.planck_top - layer.planck_bottom) * above +
                                      step / 2);
      scene.emission.step.push_back(step);
    }
    above += share[n];
  }
  scene.z_edge_m.back() = bottom + 100;
  for (Medium& other : scene.media) other.extinction.resize(medium.extinction.size(), 0.0);
  scene.media.push_back(medium);
}

struct Case {
  std::vector<PlaneParallelLayer> layers;  // top first
  std::vector<Scatterer> scatterers;
  double surface_albedo = 0, surface_planck = 0, sky_radiance = 0;
};

MonteCarloScene cells_of(const Case& c, bool uniform = false) {
  MonteCarloScene scene;
  scene.columns = {3, 2};
  scene.column_size_m = {100, 70};
  scene.z_edge_m = {0};
  for (std::size_t n = c.layers.size(); n-- > 0;) add_layer(scene, c.layers[n], c.scatterers[n], uniform);
  scene.surface_albedo = c.surface_albedo;
  scene.emission.surface.assign(6, c.surface_planck);
  scene.sky_radiance = c.sky_radiance;
  scene.sun_flux = 0;
  scene.absorption = true;
  for (std::size_t n = 0; n <= c.layers.size(); ++n) scene.levels.push_back(static_cast<int>(4 * n));
  scene.views = {{0, 0}, {60, 30}, {120, 200}};
  return scene;
}

PlaneParallelSolution solved_by_doubling(const Case& c) {
  PlaneParallelScene scene{c.layers, c.surface_albedo, 1, 0, c.sky_radiance, c.surface_planck};
  PlaneParallelEffort effort;
  effort.angles = 32;
  effort.view_mu = {1, 0.5};
  effort.view_azimuth_deg = {0};
  return solve_plane_parallel(scene, effort);
}

Moments moments_of(double g) {
  return [g](int l) { return std::pow(g, l); };
}

double rayleigh_moment(int l) { return l == 0 ? 1 : l == 2 ? 0.1 : 0; }

/// The thermal cases th2, th3 and th5 of the plane-parallel reference tables.
std::vector<Case> cases() {
  const auto hg = [](double g) { return Scatterer::henyey_greenstein(g); };
  return {{{{1, 0.5, moments_of(0.75), 1, 1}}, {hg(0.75)}, 0.2, 1},
          {{{5, 0.9, moments_of(0.85), 0, 1}}, {hg(0.85)}},
          {{{0.5, 0.1, moments_of(0), 1, 1.2},
            {2, 0.8, moments_of(0.8), 1.2, 1.5},
            {1, 0.3, rayleigh_moment, 1.5, 1.4},
            {4, 0.95, moments_of(0.85), 1.4, 2}},
           {Scatterer::isotropic(), hg(0.8), Scatterer::rayleigh(), hg(0.85)},
           0.1,
           2.2}};
}

MonteCarloEffort effort(std::int64_t photons, bool backward) { return {photons, 50, 3, 1, backward}; }

TEST(MonteCarloEmission, LayersAgreeWithDoubling) {
  for (const Case& c : cases()) {
    const PlaneParallelSolution expected = solved_by_doubling(c);
    const std::size_t layers = c.layers.size();
    for (const bool backward : {false, true}) {
      const auto result = solve_by_monte_carlo(cells_of(c), effort(backward ? 100000 : 200000, backward));
      const double least = backward ? 0.003 : 0.006;  // so that agreement means something
      for (std::size_t n = 0; n <= layers; ++n) {
        const PlaneParallelLevel& level = expected.levels[layers - n];
        expect_within(result.up[n].mean, level.up, result.up[n].mean_standard_error);
        expect_within(result.down[n].mean, level.down_diffuse, result.down[n].mean_standard_error);
        EXPECT_LT(result.up[n].mean_standard_error, least * pi * c.layers.back().planck_bottom);
      }
      for (std::size_t n = 0; n < layers; ++n) {
        const PlaneParallelLevel &below = expected.levels[layers - n], &above = expected.levels[layers - n - 1];
        double net = 0, square = 0;
        for (std::size_t k = 4 * n; k < 4 * n + 4; ++k) {
          net += result.absorbed[k].mean;
          square += result.absorbed[k].mean_standard_error;  // one photon may be absorbed in all four
        }
        expect_within(net, above.down_diffuse - above.up - below.down_diffuse + below.up, square);
      }
      const double radiance[] = {expected.radiance_up_top(0, 0), expected.radiance_up_top(1, 0),
                                 expected.radiance_down_bottom(1, 0)};
      for (int v = 0; v < 3; ++v) {
        expect_within(result.radiance[v].mean, radiance[v], result.radiance[v].mean_standard_error);
        EXPECT_LT(result.radiance[v].mean_standard_error, 0.02 * radiance[v]);
      }
    }
  }
}

TEST(MonteCarloEmission, UniformLayersAreNoDifferent) {
  const Case c = cases()[2];
  for (const bool backward : {false, true}) {
    const auto result = solve_by_monte_carlo(cells_of(c, true), effort(100000, backward));
    const PlaneParallelSolution expected = solved_by_doubling(c);
    expect_within(result.up[4].mean, expected.levels[0].up, result.up[4].mean_standard_error);
    expect_within(result.down[0].mean, expected.levels[4].down_diffuse, result.down[0].mean_standard_error);
  }
}

// Kirchhoff: cells, surface and sky of one temperature have its Planck radiance everywhere.
TEST(MonteCarloEmission, EnclosureHasThePlanckRadianceEverywhere) {
  auto scene = cells_of({{{3, 0.7, moments_of(0.85), 1, 1}}, {Scatterer::henyey_greenstein(0.85)}, 0.3, 1, 1});
  for (std::size_t c = 0; c < scene.media[0].extinction.size(); c += 5) scene.media[0].extinction[c] *= 8;
  const auto forward = solve_by_monte_carlo(scene, effort(200000, false));
  const auto expect_all = [](const Plane& plane, double expected) {
    expect_within(plane.mean, expected, plane.mean_standard_error);
    for (std::size_t c = 0; c < plane.value.size(); ++c) {
      expect_within(plane.value[c], expected, plane.standard_error[c]);
    }
  };
  for (std::size_t n = 0; n < scene.levels.size(); ++n) {
    expect_all(forward.up[n], pi);
    expect_all(forward.down[n], pi);
    EXPECT_LT(forward.up[n].mean_standard_error, 0.006 * pi);
  }
  for (const Plane& layer : forward.absorbed) expect_all(layer, 0);
  for (const Plane& view : forward.radiance) expect_all(view, 1);
  // Backward, all photons find the same.
  const auto backward = solve_by_monte_carlo(scene, effort(10000, true));
  for (const Plane& up : backward.up) EXPECT_NEAR(up.mean, pi, 1e-12);
  for (const Plane& down : backward.down) EXPECT_NEAR(down.mean, pi, 1e-12);
  for (const Plane& layer : backward.absorbed) EXPECT_NEAR(layer.mean, 0, 1e-12);
  for (const Plane& view : backward.radiance) EXPECT_NEAR(view.mean, 1, 1e-12);
}

TEST(MonteCarloEmission, AbsorberEmitsAsExponentialIntegralsSay) {
  // Isothermal: pi B (1 - 2 E3(tau)), with E3(1) = .10969197 and, for ground as warm, pi B up at the top.
  Case c{{{1, 0, moments_of(0), 2, 2}}, {Scatterer::isotropic()}};
  for (const bool backward : {false, true}) {
    c.surface_planck = 0;
    auto result = solve_by_monte_carlo(cells_of(c), effort(200000, backward));
    for (const Plane& plane : {result.up[1], result.down[0]}) {
      expect_within(plane.mean, 2 * pi * (1 - 2 * 0.10969197), plane.mean_standard_error);
    }
    c.surface_planck = 2;
    result = solve_by_monte_carlo(cells_of(c), effort(200000, backward));
    expect_within(result.up[1].mean, 2 * pi, result.up[1].mean_standard_error);
  }
}

/// Cells of random extinction and temperature over ground of different temperatures.
MonteCarloScene rough() {
  MonteCarloScene scene = cells_of(cases()[2]);
  unsigned state = 1;
  const auto random = [&] { return (state = state * 1664525u + 1013904223u) / 4294967296.0; };
  for (Medium& medium : scene.media) {
    for (double& e : medium.extinction) e *= 4 * random() * random();
  }
  for (std::size_t c = 0; c < scene.emission.planck.size(); ++c) {
    scene.emission.planck[c] *= 0.5 + random();
    scene.emission.step[c] = scene.emission.planck[c] * (2 * random() - 1);
  }
  for (double& planck : scene.emission.surface) planck *= 0.5 + random();
  scene.sky_radiance = 0.3;
  scene.surface_albedo = 0.4;
  return scene;
}

// Forward and backward share the flights alone: sources, tallies and noise are different.
TEST(MonteCarloEmission, ForwardAndBackwardAgree) {
  for (const bool open : {false, true}) {
    MonteCarloScene scene = rough();
    scene.open_sides = open;
    const auto a = solve_by_monte_carlo(scene, effort(300000, false)),
               b = solve_by_monte_carlo(scene, effort(300000, true));
    double chi = 0, number = 0;
    const auto compare = [&](const std::vector<Plane>& forward, const std::vector<Plane>& backward) {
      for (std::size_t n = 0; n < forward.size(); ++n) {
        const Plane &f = forward[n], &g = backward[n];
        expect_within(f.mean, g.mean, std::hypot(f.mean_standard_error, g.mean_standard_error));
        for (std::size_t c = 0; c < f.value.size(); ++c) {
          const double error = std::hypot(f.standard_error[c], g.standard_error[c]);
          if (error == 0) continue;
          chi += std::pow((f.value[c] - g.value[c]) / error, 2);
          number += 1;
        }
      }
    };
    compare(a.up, b.up);
    compare(a.down, b.down);
    compare(a.absorbed, b.absorbed);
    compare(a.radiance, b.radiance);
    EXPECT_GT(number, 150);
    EXPECT_NEAR(chi / number, 1, 0.35);  // correlated columns: about 4 of sqrt(2 / number)
  }
}

TEST(MonteCarloEmission, SunAndEmissionAddUp) {
  MonteCarloScene both = rough();
  both.sun_flux = 2;
  both.sun_zenith_deg = 50;
  MonteCarloScene sun = both, heat = both;
  sun.emission = {};
  sun.sky_radiance = 0;
  heat.sun_flux = 0;
  const auto a = solve_by_monte_carlo(both, effort(200000, false)),
             b = solve_by_monte_carlo(sun, effort(200000, false)),
             c = solve_by_monte_carlo(heat, effort(200000, false));
  const auto compare = [](const Plane& p, const Plane& q, const Plane& r) {
    expect_within(p.mean, q.mean + r.mean,
                  std::hypot(p.mean_standard_error, q.mean_standard_error, r.mean_standard_error));
  };
  for (std::size_t n = 0; n < a.up.size(); ++n) {
    compare(a.up[n], b.up[n], c.up[n]);
    compare(a.down[n], b.down[n], c.down[n]);
  }
  for (std::size_t n = 0; n < a.absorbed.size(); ++n) compare(a.absorbed[n], b.absorbed[n], c.absorbed[n]);
  for (std::size_t n = 0; n < a.radiance.size(); ++n) compare(a.radiance[n], b.radiance[n], c.radiance[n]);
}

TEST(MonteCarloEmission, BackwardPhotonsDoNotFindTheSun) {
  MonteCarloScene scene = rough();
  scene.sun_flux = 1;
  EXPECT_THROW(solve_by_monte_carlo(scene, effort(1000, true)), std::invalid_argument);
}

}  // namespace
}  // namespace cloudbow::reference
