// Actinic flux in empty air. Truth: the same field with air of hardly any matter.
#include <gtest/gtest.h>

#include "cloudbow/medium/cloud_makers.hpp"
#include "cloudbow/sphere/interpolation_weights.hpp"
#include "cloudbow/transport/solver.hpp"
#include "solve_test_tools.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

// Truth: the same solve without clear cells, which scatter no light. Thin subdivided levels lie below a thick clear one
// here. Diffusion in the clear level once made this very cloud diverge.
TEST(Solve, ActinicFluxInClearAirCostsNoSweeps) {
  CloudMakerOptions cumulus;
  cumulus.kind = "cumulus";
  cumulus.cells = {16, 16, 32};
  cumulus.voxel_size_m = {40, 40, 40};
  cumulus.optical_depth = 15;
  cumulus.cover = .3;
  cumulus.seed = 155;
  cumulus.base_m = 40;
  const CloudField cloud = make_cloud(cumulus);
  CloudOptics optics;
  optics.single_scattering_albedo = .99;
  Problem problem =
      problem_of(make_optical_grid(&cloud, optics, {}, {0, 0, 0}, {640, 640, 1280}, true, 1, {0.}, LevelOptions{}),
                 PhaseFunction::henyey_greenstein(.75), .12, 35);
  problem.surface.albedo = .5;
  SolverOptions options = coarse();
  options.max_level_optical_depth = 2;
  options.max_sweeps = 30;
  const Solution without = solve(problem, options);
  options.actinic = true;
  const Solution with = solve(problem, options);
  EXPECT_TRUE(without.report.converged);
  EXPECT_TRUE(with.report.converged);
  EXPECT_LE(with.report.sweeps, without.report.sweeps + 1);
  // The iteration's tolerance of 1e-4, and slopes of light that are found near its end: measured 1.2e-4.
  EXPECT_NEAR(with.ledger.reflectance, without.ledger.reflectance, 2e-4);
}

}  // namespace
}  // namespace cloudbow
