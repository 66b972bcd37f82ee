// Phase functions at ordinates and control points. Truth: delta-M of Henyey and Greenstein's function of
// order N counts g^N as unscattered.
#include <gtest/gtest.h>

#include <cmath>

#include "cloudbow/core/error.hpp"
#include "transport/scattering/discretisation.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

TEST(Discretisation, ForwardFractionsArePowersOfTheAsymmetryParameter) {
  const SolverOptions options = coarse_options();  // orders 6 and 8
  const Discretisation made = discretise({PhaseFunction::henyey_greenstein(.8), PhaseFunction::henyey_greenstein(.5)},
                                         travel_along(-.6, 20), options);
  ASSERT_EQ(made.table.size(), 2U);
  const double g[] = {.8, .5};
  for (std::size_t p = 0; p < 2; ++p) {
    EXPECT_NEAR(made.diffuse_fraction()[p], std::pow(g[p], 6), 1e-14);
    EXPECT_NEAR(made.beam_fraction()[p], std::pow(g[p], 8), 1e-14);
    EXPECT_NEAR(made.gather_fraction()[p], std::pow(g[p], Discretisation::gather_order), 1e-14);
  }
  EXPECT_EQ(made.points.size(), 42);
  EXPECT_EQ(made.ordinates.size(), make_ordinate_set("double-gauss-6x8").size());
}

TEST(Discretisation, WithoutASunHasNoColumnOfTheBeam) {
  const SolverOptions options = coarse_options();
  const std::vector<PhaseFunction> phase{PhaseFunction::isotropic()};
  EXPECT_EQ(discretise(phase, std::nullopt, options).table[0].points_from_beam.size(), 0);
  EXPECT_EQ(discretise(phase, travel_along(-.6, 20), options).table[0].points_from_beam.size(), 42);
}

TEST(Discretisation, NamesAndCountsThatDoNotExistAreRefused) {
  SolverOptions options = coarse_options();
  options.directions = "double-gauss";
  EXPECT_THROW(discretise({PhaseFunction::isotropic()}, std::nullopt, options), InputError);
  options = coarse_options();
  options.control_points = 43;
  EXPECT_THROW(discretise({PhaseFunction::isotropic()}, std::nullopt, options), InputError);
}

}  // namespace
}  // namespace cloudbow
