// Power of the light sources. Truth: closed forms of slabs, and means over columns written out.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "transport/problem/power.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

// Columns of two cells with these optical depths of absorption and Planck radiances, at (k*ny + j)*nx + i.
Problem columns_of(int nx, const std::vector<float>& absorption, const std::vector<float>& planck) {
  Problem problem;
  const std::vector<float> scattering(absorption.size(), 1.F);
  problem.grid = make_grid(make_box(nx, 1, static_cast<int>(absorption.size()) / nx), absorption, {scattering});
  problem.phase = {PhaseFunction::isotropic()};
  problem.grid.planck = planck;
  problem.grid.planck_step.assign(planck.size(), 0.F);
  return problem;
}

TEST(Power, SunAndSkyGoThroughTheTop) {
  Problem problem;
  EXPECT_EQ(incident_power(problem), 0);
  problem.sky_radiance = 2;
  EXPECT_DOUBLE_EQ(incident_power(problem), 2 * pi);
  problem.sun = Sun{travel_along(-.25, 10), 8.};
  EXPECT_DOUBLE_EQ(incident_power(problem), 2 + 2 * pi);
}

TEST(Power, GroundEmitsWhatItDoesNotReflect) {
  Problem problem = columns_of(2, {0, 0, 0, 0}, {});
  problem.surface.albedo = .4;
  EXPECT_EQ(ground_emission(problem), 0);
  problem.surface.planck = 3;
  EXPECT_DOUBLE_EQ(ground_emission(problem), .6 * 3 * pi);
  problem.surface.planck_map = {1, 4};
  EXPECT_DOUBLE_EQ(ground_emission(problem), .6 * 2.5 * pi);
  problem.surface.albedo_map = {.5F, .25F};
  EXPECT_DOUBLE_EQ(ground_emission(problem), (.5 * 1 + .75 * 4) / 2 * pi);
  problem.surface.planck_map.clear();
  EXPECT_DOUBLE_EQ(ground_emission(problem), .625 * 3 * pi);
}

TEST(Power, GroundWithABrdfCountsAsBlack) {
  Problem problem = columns_of(1, {0}, {});
  problem.surface.brdf = SurfaceBrdf::lambertian(.4);
  problem.surface.albedo = .4;
  problem.surface.planck = 3;
  EXPECT_DOUBLE_EQ(ground_emission(problem), 3 * pi);
}

TEST(Power, IsothermalMatterHasTheEmissivityOfItsDepthOnBothSides) {
  EXPECT_EQ(matter_emission(columns_of(1, {1, 2}, {})), 0);
  for (const float depth : {1e-7F, .1F, 1.F}) {
    const Problem problem = columns_of(1, {depth, 2 * depth, 3 * depth}, {2, 2, 2});
    const double emissivity = -std::expm1(-5. / 3 * 6 * static_cast<double>(depth));
    // The depths of the cells are rounded to float.
    EXPECT_NEAR(matter_emission(problem), 2 * 2 * pi * emissivity, 1e-6 * emissivity);
  }
}

TEST(Power, OpaqueCellsHideWhatIsBehindThem) {
  // Down from the lowest cell, up from the highest.
  EXPECT_DOUBLE_EQ(matter_emission(columns_of(1, {1000, 1000, 1000}, {3, 9, 5})), (3 + 5) * pi);
}

TEST(Power, IsTheMeanOverColumns) {
  const double opaque = matter_emission(columns_of(1, {1000, 1000}, {3, 5}));
  const double thin = matter_emission(columns_of(1, {.1F, .2F}, {2, 1}));
  EXPECT_DOUBLE_EQ(matter_emission(columns_of(2, {1000, .1F, 1000, .2F}, {3, 2, 5, 1})), (opaque + thin) / 2);
  const double one = 5. / 3 * static_cast<double>(.1F), two = 5. / 3 * static_cast<double>(.2F);
  EXPECT_DOUBLE_EQ(thin, pi * (2 * -std::expm1(-one) * (1 + std::exp(-two)) - std::expm1(-two) * (1 + std::exp(-one))));
}

}  // namespace
}  // namespace cloudbow
