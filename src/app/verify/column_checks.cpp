// Homogeneous layers: closed forms, published numbers, reciprocity.
#include <cmath>
#include <numbers>

#include "app/verify/checks.hpp"
#include "app/verify/scenes.hpp"
#include "cloudbow/transport/solver.hpp"

namespace cloudbow {
namespace {

double beers_law() {
  Worst worst;
  for (const double mu0 : {1., .5, .1}) {
    for (const double optical_depth : {.01, 1., 5.}) {
      for (const double albedo : {0., .9}) {
        const Solution solution = solve(
            layer_problem(optical_depth, albedo, PhaseFunction::henyey_greenstein(.85), mu0), column_options("draft"));
        const auto& edge = solution.box.z_edge_m;
        for (std::size_t e = 0; e < edge.size(); ++e) {
          const double above = optical_depth * (1 - edge[e] / edge.back());
          worst.meet(solution.profile_direct_flux[e] / mu0, std::exp(-above / mu0));
          worst.meet(static_cast<double>(solution.direct_flux[e]) / mu0, std::exp(-above / mu0));
        }
        if (albedo == 0) {  // and there is no other light
          worst.meet(solution.ledger.reflectance);
          worst.meet(solution.ledger.transmittance, std::exp(-optical_depth / mu0));
        }
      }
    }
  }
  return worst.value();
}

// In such a thin layer every photon scatters at most once: F0 tau of light, half of it up. Both phase functions are the
// same forward and backward.
double thin_layer() {
  constexpr double optical_depth = 1e-6;
  Worst worst;
  for (const PhaseFunction& phase : {PhaseFunction::isotropic(), PhaseFunction::rayleigh()}) {
    for (const double mu0 : {1., .5}) {
      const Solution solution = solve(layer_problem(optical_depth, 1, phase, mu0), column_options("draft"));
      worst.meet(solution.profile_upwelling_flux.back() / (optical_depth / 2), 1);
      worst.meet(solution.profile_downwelling_diffuse_flux.front() / (optical_depth / 2), 1);
      worst.meet((mu0 - solution.profile_direct_flux.front()) / optical_depth, 1);
    }
  }
  return worst.value();
}

double henyey_greenstein(double g, double cosine) { return (1 - g * g) / std::pow(1 + g * g - 2 * g * cosine, 1.5); }

// Radiance of a thin layer, up: I = P F0 mu0/(mu + mu0) [1 - exp(-tau (1/mu + 1/mu0))] / (4 pi) (Chandrasekhar 1960,
// III, Eq. 93), with the scene's own conversion of azimuths to directions. A sensor at the sun's azimuth sees light
// scattered straight back, one opposite light scattered forward by 60 degrees: 27 times as much.
double azimuths_of_thin_air() {
  constexpr double tau = 1e-5, mu = .5, g = .8, sun_azimuth = 20;
  Scene scene;
  scene.phase_functions = {{"droplets", PhaseFunction::henyey_greenstein(g), false}};
  scene.layers = {{0, 1000, tau, 1, 0}};
  scene.sun = SceneSun{60, sun_azimuth, 1};
  scene.solver.accuracy = "draft";
  constexpr std::array<double, 4> offset{0, 180, 90, -90};
  for (const double a : offset) scene.radiances.push_back({"view", 60, sun_azimuth + a});
  AssembledScene assembled = assemble(scene, std::numeric_limits<std::uint64_t>::max());
  assembled.options.fit.cache_directory.clear();
  assembled.options.threads = 1;
  const Solution solution = solve(assembled.problem, assembled.options);
  Worst worst;
  for (std::size_t v = 0; v < offset.size(); ++v) {
    const double cosine = -mu * mu - (1 - mu * mu) * std::cos(offset[v] * pi / 180);
    const double wanted = henyey_greenstein(g, cosine) / 2 * -std::expm1(-2 * tau / mu) / (4 * pi);
    worst.meet(static_cast<double>(solution.images.at(v).radiance.at(0)) / wanted, 1);
  }
  return worst.value();
}

struct PlaneParallel {
  PhaseFunction phase;
  double optical_depth;
  double single_scattering_albedo;
  double mu0;  // 0: no sun, sky of radiance 1
  double surface_albedo;
  double up;            // at the top, W m-2; irradiance 1
  double down_diffuse;  // at the bottom
};

double deviation_from(const PlaneParallel& c) {
  Problem problem = layer_problem(c.optical_depth, c.single_scattering_albedo, c.phase, c.mu0 > 0 ? c.mu0 : 1);
  problem.surface.albedo = c.surface_albedo;
  if (c.mu0 == 0) {
    problem.sun.reset();
    problem.sky_radiance = 1;
  }
  const Solution solution = solve(problem, column_options());
  const double incident = c.mu0 > 0 ? c.mu0 : pi;
  Worst worst;
  worst.meet(solution.profile_upwelling_flux.back() / incident, c.up / incident);
  worst.meet(solution.profile_downwelling_diffuse_flux.front() / incident, c.down_diffuse / incident);
  return worst.value();
}

// cdisort 2.1.3, 128 streams and more, from tests/data/plane_parallel_subset.json (tests/data/README.md says how they
// were made): a_iso_tau1_w1_mu0.1, a_iso_tau32_w0.99_mu0.1, b_ray_tau1_w1_mu0.5, d_hg0.85_tau10_w1_mu0.5_A0.2,
// d_hg0.85_tau10_w0.99_mu0.5_A0, d_hg0.85_tau10_w0.9_mu0.5_A0.8, d_hg0.85_tau0.1_w0.9_mu0.5_A0,
// i_isotop_hg0.85_tau10_w0.99_A0.2.
double plane_parallel_table() {
  const PhaseFunction iso = PhaseFunction::isotropic(), rayleigh = PhaseFunction::rayleigh(),
                      droplets = PhaseFunction::henyey_greenstein(.85);
  Worst worst;
  for (const PlaneParallel& c : {PlaneParallel{iso, 1, 1, .1, 0, .06976641979, .03022904017},
                                 PlaneParallel{iso, 32, .99, .1, 0, .08775100348, 7.792818334e-05},
                                 PlaneParallel{rayleigh, 1, 1, .5, 0, .2494939604, .1828383982},
                                 PlaneParallel{droplets, 10, 1, .5, .2, .3222518021, .2221852464},
                                 PlaneParallel{droplets, 10, .99, .5, 0, .2580406957, .1562211563},
                                 PlaneParallel{droplets, 10, .9, .5, .8, .1060728612, .03368023369},
                                 PlaneParallel{droplets, .1, .9, .5, 0, .007338808861, .07292035555},
                                 PlaneParallel{droplets, 10, .99, 0, .2, 1.541060975, 1.26944498}}) {
    worst.meet(deviation_from(c));
  }
  return worst.value();
}

// The same set, e_ext_tau10000_w1_g0.5_mu0.05.
double thick_layer() {
  const Solution solution = solve(layer_problem(1e4, 1, PhaseFunction::henyey_greenstein(.5), .05), column_options());
  return std::abs(solution.profile_downwelling_diffuse_flux.front() / 6.167157125e-06 - 1);
}

// pi I / (mu0 F0) of light from sun to sensor.
double reflection_factor(double mu0, double mu, double azimuth_deg) {
  SolverOptions options = column_options();
  options.views = {{"view", travel_to_sensor(mu, azimuth_deg)}};
  const Solution solution = solve(layer_problem(2, .99, PhaseFunction::henyey_greenstein(.7), mu0), options);
  return pi * static_cast<double>(solution.images.at(0).radiance.at(0)) / mu0;
}

double reciprocity_of_layer() { return std::abs(reflection_factor(.9, .3, 60) / reflection_factor(.3, .9, 60) - 1); }

}  // namespace

std::vector<PhysicalCheck> column_checks() {
  return {
      // Optics are kept in float: a relative 6e-8 of the optical depth.
      {"beer-law", "direct light falls off as exp(-tau/mu0), and is all light if nothing scatters", "of incident", 1e-6,
       beers_law},
      // Light that is scattered twice, some tau ln(1/tau), and differences of fluxes in float optics.
      {"thin-layer", "of an optical depth of 1e-6 the fluxes are single scattering", "of it", 1e-4, thin_layer},
      // Light scattered twice: some tau. The rest is the delta-M correction of the first order.
      {"azimuth", "a sensor at the sun's azimuth sees light scattered back, one opposite light scattered forward",
       "of radiance", 1e-3, azimuths_of_thin_air},
      // Largest error of these eight .006 %; of all such cases .07 % (docs/validation.md).
      {"plane-parallel", "fluxes of layers are those that discrete ordinates find", "of incident", 3e-4,
       plane_parallel_table},
      // 400 levels, the thickest of an optical depth of 200; .13 % as measured.
      {"thick-layer", "of an optical depth of 1e4 the transmitted flux is that of discrete ordinates", "of it", 3e-3,
       thick_layer},
      // Fits of anisotropic scattering are not quite reciprocal, nor are levels as seen along two slants: 4e-4.
      {"reciprocity-layer", "sun and sensor can change places over a layer", "of radiance", 3e-3, reciprocity_of_layer},
  };
}

}  // namespace cloudbow
