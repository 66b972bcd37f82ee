// Mean radiance of cells along one direction. Truth: Beer's law in levels of one extinction.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "transport/observers/radiance_march.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

constexpr double sky = 1.7, albedo = .4, extinction = .8;

TEST(RadianceMarch, FollowsBeersLawDownAndUp) {
  const BoxGrid box = make_box(4, 3, 3);
  Problem problem;
  problem.grid = make_grid(box, std::vector<float>(cells_of(box), static_cast<float>(extinction)), 0);
  problem.phase = {PhaseFunction::isotropic()};
  problem.sky_radiance = sky;
  problem.surface.albedo = albedo;
  const SolverOptions options = coarse_options();
  const auto system = make_system<double>(problem, discretise(problem.phase, std::nullopt, options), options);
  AngularField<double> field(system.ordinates.size(), system.cells->size());
  SweepWorkspace<double> work;
  const SweepFluxes<double> fluxes = sweep(system, field, true, work);
  const GroundRadiance<double> ground = ground_of_iteration(system, fluxes);
  const std::vector<double> dark(system.cells->size() + lane_padding, 0.);
  const double from_ground = albedo * fluxes.surface_flux[0] / std::numbers::pi;
  RadianceMarch<double> march;
  for (const double mu : {-.9, -.4, .3, .8}) {
    const std::span<const double> mean =
        march.mean_radiance(problem, system, ground, nullptr, travel_along(mu, 50), dark);
    const double depth = extinction / std::abs(mu);
    const double in_level = (1 - std::exp(-depth)) / depth;
    const auto level_cells = static_cast<std::size_t>(box.columns());
    for (std::size_t c = 0; c < cells_of(box); ++c) {
      const auto crossed = static_cast<double>(mu < 0 ? 2 - c / level_cells : c / level_cells);
      const double entering = (mu < 0 ? sky : from_ground) * std::exp(-depth * crossed);
      EXPECT_NEAR(mean[c] / (entering * in_level), 1, 1e-6) << mu << ' ' << c;  // extinction has 32 bits
    }
  }
}

}  // namespace
}  // namespace cloudbow
