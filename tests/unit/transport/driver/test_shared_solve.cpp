// All results of a solve that ranks share. Truth: the same solve by one process, with the same bits.
#include <gtest/gtest.h>

#include <cmath>
#include <mutex>

#include "../../thread_ranks.hpp"
#include "cloudbow/transport/solver.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

struct Case {
  const char* name;
  bool open = false;
  bool air = false;
  bool uneven_ground = false;
  bool independent_columns = false;
  bool packed = false;
};
constexpr Case cases[] = {{"as usual"},
                          {"open sides", true},
                          {"absorbing air in blocks", false, true},
                          {"uneven ground", false, false, true},
                          {"independent columns", false, false, false, true},
                          {"float16", false, false, false, false, true}};

/// A cloud with gaps, wide enough that cells are marched along all axes.
Problem clouds(const Case& of) {
  BoxGrid box = make_box(22, 18, 6);
  box.periodic = !of.open;
  box.dx_m = box.dy_m = 60;
  for (double& z : box.z_edge_m) z *= 40;
  std::vector<float> extinction = random_extinction(box, .05, 7);
  for (std::size_t c = 0; c < extinction.size(); ++c) {
    if (c % 22 > 13) extinction[c] = 0;
  }
  Problem problem;
  problem.phase = {PhaseFunction::henyey_greenstein(.85)};
  if (of.air) {
    problem.grid = grid_in_blocks(box, extinction, {std::vector<double>(6, 2e-4), std::vector<double>(6, 5e-5)}, 0);
    problem.phase.push_back(PhaseFunction::rayleigh());
  } else {
    problem.grid = make_grid(box, extinction, .98);
  }
  problem.sun = Sun{travel_along(-.4, 70), 1.};
  problem.surface.albedo = .2;
  if (of.uneven_ground) problem.surface.brdf = SurfaceBrdf::rpv(.1, .7, -.1, .1);
  return problem;
}

SolverOptions options_of(const Case& of) {
  SolverOptions options = coarse_options();
  options.max_sweeps = 7;
  options.half_precision_radiance = of.packed;
  options.absorption = options.actinic = true;
  options.independent_columns = of.independent_columns;
  if (of.independent_columns) return options;
  options.circumsolar_half_angle = .05;
  options.radiance_field = !of.air;
  options.views = {{"from above", travel_along(.8, 20)}};
  options.cameras = {make_camera("from the ground", Camera::Projection::fisheye,
                                 {.position_m = {300, 300, 1}, .look_at_m = {300, 300, 100}, .up = {0, 1, 0}}, 3, 9,
                                 9)};
  return options;
}

/// All values of a solution, for comparison of their bits.
std::vector<double> values_of(const Solution& solution) {
  std::vector<double> values;
  const auto add = [&](const auto& of) { values.insert(values.end(), of.begin(), of.end()); };
  add(solution.upwelling_flux);
  add(solution.downwelling_diffuse_flux);
  add(solution.direct_flux);
  add(solution.circumsolar_flux);
  add(solution.profile_upwelling_flux);
  add(solution.profile_downwelling_diffuse_flux);
  add(solution.absorbed_power);
  for (const float flux : solution.actinic_flux) values.push_back(std::isnan(flux) ? -1 : flux);
  for (const RadianceImage& image : solution.images) add(image.radiance);
  for (const CameraImage& image : solution.camera_images) {
    for (const float radiance : image.radiance) values.push_back(std::isnan(radiance) ? -1 : radiance);
  }
  if (solution.radiance_field) add(solution.radiance_field->radiance);
  values.insert(values.end(), {solution.ledger.residual, solution.ledger.reflectance, solution.ledger.absorptance,
                               solution.report.gather_rescaling, static_cast<double>(solution.report.sweeps)});
  return values;
}

TEST(SharedSolve, HasTheBitsOfOneProcess) {
  for (const Case& of : cases) {
    SCOPED_TRACE(of.name);
    const Problem problem = clouds(of);
    const SolvePlan plan(problem, options_of(of));
    const std::vector<double> truth = values_of(solve(plan));
    for (const int size : {1, 2, 3, 4, 8, 9}) {
      SCOPED_TRACE(size);
      std::mutex one_at_a_time;  // to compare
      ThreadRanks::run(size, [&](Ranks& ranks) {
        const Solution solution = solve(plan, {}, {.ranks = &ranks});
        const std::lock_guard lock(one_at_a_time);
        if (ranks.is_first()) {
          EXPECT_EQ(values_of(solution), truth);
        } else {
          EXPECT_TRUE(solution.upwelling_flux.empty());
        }
      });
    }
  }
}

// With and without other parts of its cells, as coarse truncations have them.
TEST(SharedSolve, HandsOnItsLightAsOneProcessDoes) {
  const Problem problem = clouds(cases[0]);
  SolverOptions options = coarse_options();
  options.max_sweeps = 14;  // so that slopes are found
  const SolvePlan plan(problem, options);
  SolverOptions others = options;
  others.directions = "double-gauss-4x8";
  for (const double depth : {0., .2}) {
    others.max_level_optical_depth = depth;
    const SolvePlan other = plan.with(others);
    const auto values = [&](Ranks* ranks) {
      CellLight light;
      solve(plan, {}, {.ranks = ranks, .light = &light});
      return values_of(solve(other, {}, {.ranks = ranks, .light = &light}));
    };
    const std::vector<double> truth = values(nullptr);
    EXPECT_NE(truth, values_of(solve(other)));
    for (const int size : {2, 3, 4, 8, 9}) {
      ThreadRanks::run(size, [&](Ranks& ranks) {
        const std::vector<double> here = values(&ranks);
        if (!ranks.is_first()) return;
        EXPECT_EQ(here, truth) << size << ", " << depth;
      });
    }
  }
}

}  // namespace
}  // namespace cloudbow
