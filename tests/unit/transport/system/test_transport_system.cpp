// Parts of the scene in the iteration. Truth: closed forms of delta-M scaling and of single scattering.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "transport/system/transport_system.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

TEST(ScaledExtinction, LeavesOutWhatCountsAsUnscattered) {
  const BoxGrid box = make_box(2, 1, 1);
  const OpticalGrid grid = make_grid(box, {.1F, .4F}, {{1.F, 2.F}, {3.F, 0.F}});
  const std::vector<double> scaled = scaled_extinction<double>(grid, {.25, .5});
  EXPECT_NEAR(scaled[0], .1 + .75 * 1 + .5 * 3, 1e-6);  // numbers of 32 bits
  EXPECT_NEAR(scaled[1], .4 + .75 * 2, 1e-6);
}

TEST(AddSingleScattering, IsTheShareOfTheBeamThatIsScattered) {
  const std::vector<float> scattering{1.F, .5F};
  const std::vector<double> extinction{2., 4.}, irradiance{10., 20.};
  std::vector<SingleScattering<double>> first_order;
  add_single_scattering<double>(
      first_order, [](double c) { return 1 + c; }, scattering, .5, extinction, irradiance);
  ASSERT_EQ(first_order.size(), 1U);
  EXPECT_EQ(first_order[0].phase(.5), 1.5);
  EXPECT_NEAR(first_order[0].intensity[0], .5 * 1 / 2. * 10 / (4 * std::numbers::pi), 1e-14);
  EXPECT_NEAR(first_order[0].intensity[1], .5 * .5 / 4. * 20 / (4 * std::numbers::pi), 1e-14);
}

TEST(TransportSystem, HasThePowerThatComesInThroughTheTop) {
  const BoxGrid box = make_box(2, 2, 2);
  Problem problem;
  problem.grid = make_grid(box, std::vector<float>(cells_of(box), .3F), .9);
  problem.phase = {PhaseFunction::isotropic()};
  problem.sun = Sun{travel_along(-.6, 20), 2.};
  problem.sky_radiance = .25;
  const SolverOptions options = coarse_options();
  const auto system = make_system<double>(problem, discretise(problem.phase, problem.sun->travel, options), options);
  EXPECT_NEAR(system.incident, 2 * .6 + .25 * std::numbers::pi, 1e-12);
  EXPECT_NEAR(system.power, system.incident, 1e-12) << "nothing emits";
  EXPECT_EQ(system.cells->size(), cells_of(box));
}

}  // namespace
}  // namespace cloudbow
