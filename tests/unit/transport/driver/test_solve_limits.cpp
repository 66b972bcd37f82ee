// Input that a solve refuses, and state that it leaves as it was.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <limits>

#include "cloudbow/core/error.hpp"
#include "cloudbow/transport/solver.hpp"
#include "limit_test_tools.hpp"
#include "transport/driver/path_load.hpp"
#include "transport/problem/finite.hpp"
#include "transport/rays/path_pattern.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Every value is proportional to the light, and a power of two changes no digit of a float: truth is the solution of
// unit light.
void expect_scaled(double power) {
  Problem problem = cloudy();
  const Solution one = solve(problem, quick());
  problem.sun->irradiance *= power;
  problem.sky_radiance *= power;
  const Solution scaled = solve(problem, quick());
  const auto same = [power](const std::vector<float>& of, const std::vector<float>& as) {
    ASSERT_EQ(of.size(), as.size());
    for (std::size_t n = 0; n < of.size(); ++n) ASSERT_EQ(of[n], static_cast<float>(power) * as[n]) << n;
  };
  same(scaled.upwelling_flux, one.upwelling_flux);
  same(scaled.downwelling_diffuse_flux, one.downwelling_diffuse_flux);
  same(scaled.direct_flux, one.direct_flux);
  same(scaled.absorbed_power, one.absorbed_power);
  same(scaled.actinic_flux, one.actinic_flux);
  EXPECT_EQ(scaled.ledger.residual, one.ledger.residual);
  EXPECT_EQ(scaled.report.sweeps, one.report.sweeps);
}

TEST(SolveLimits, FaintAndBrightLightHaveTheDigitsOfUnitLight) {
  expect_scaled(std::ldexp(1., -78));  // 3e-24
  expect_scaled(std::ldexp(1., 80));   // 1e24
}

TEST(SolveLimits, LightThatFloatCannotHoldIsRefused) {
  for (const double irradiance : {1e38, 1e-79, -1., std::numeric_limits<double>::infinity(), nan}) {
    Problem problem = cloudy();
    problem.sun->irradiance = irradiance;
    EXPECT_THAT([&] { solve(problem, quick()); }, ThrowsMessage<InputError>(HasSubstr("irradiance of the sun")))
        << irradiance;
    problem = cloudy();
    problem.sky_radiance = irradiance;
    EXPECT_THAT([&] { solve(problem, quick()); }, ThrowsMessage<InputError>(HasSubstr("radiance of the sky")))
        << irradiance;
  }
}

TEST(SolveLimits, SegmentsAreCountedBeforeAPatternIsMade) {
  const BoxGrid box = make_box(4, 3, 3);
  for (const double mu : {-.9, -.3, -.01, .002}) {
    for (const double azimuth : {0., 37., 200.}) {
      const Direction travel = travel_along(mu, azimuth);
      const auto made = static_cast<double>(make_path_pattern(box, travel, .3, .8, false, {0, 3}).segments.size());
      const double counted = pattern_segments(box, travel, false, {0, 3});
      EXPECT_LE(made, counted);
      EXPECT_GE(made, counted - 5);  // the level that a fraction of a cell more would have cut
    }
  }
}

TEST(SolveLimits, RaysThatCrossTooManyCellsAreRefusedWithTheZenithAngleThatIsNot) {
  EXPECT_THAT(
      [] { solve(under_zenith(89.9999999), quick()); },
      ThrowsMessage<InputError>(testing::AllOf(HasSubstr("too many cells"), HasSubstr("a zenith angle of at most"))));
  EXPECT_THAT([] { predicted_memory(under_zenith(89.9999999), quick()); },
              ThrowsMessage<InputError>(HasSubstr("sun:")));
  // 3 m of height and cells of 1 m: 5e6 segments at a slope of 5e6/3.
  const double most = std::atan(5e6 / 3) * 180 / std::numbers::pi;
  EXPECT_NO_THROW(check_paths(SolvePlan(under_zenith(most - 1e-5), quick())));
  EXPECT_THROW(check_paths(SolvePlan(under_zenith(most + 1e-5), quick())), InputError);
  SolverOptions columns = quick();
  columns.independent_columns = true;
  EXPECT_NO_THROW(check_paths(SolvePlan(under_zenith(89.9999999), columns)));
}

TEST(SolveLimits, NarrowCellsAreRefusedForTheirOrdinates) {
  Problem problem = cloudy();
  problem.grid.box.dx_m = problem.grid.box.dy_m = 1e-6;
  EXPECT_THROW(check_paths(SolvePlan(problem, quick())), InputError);
  problem.sun.reset();
  EXPECT_THAT([&] { check_paths(SolvePlan(problem, quick())); }, ThrowsMessage<InputError>(HasSubstr("directions:")));
}

// The ledger is in terms of the power through the top, here a hundredth of the power through the sides: in float its
// residual would be 1e-5.
TEST(SolveLimits, OpenDomainsUnderALowSunCloseTheirLedgerOrAreRefused) {
  SolverOptions options = quick();
  options.flux_levels = FluxLevels::boundaries;
  Problem low = under_zenith(89.7, false);
  low.sky_radiance = 0;
  const Solution solution = solve(low, options);
  EXPECT_TRUE(solution.report.converged);
  EXPECT_LT(std::abs(solution.ledger.residual), options.energy_tolerance);
  EXPECT_GT(solution.ledger.side_gain, 100);
  EXPECT_THAT([] { solve(under_zenith(89.99, false), quick()); },
              ThrowsMessage<InputError>(HasSubstr("through its sides")));
}

TEST(SolveLimits, WhatIsNotANumberIsNamedAndWhereItIs) {
  const Solution whole = solve(cloudy(), quick());
  EXPECT_NO_THROW(check_finite(whole));
  const auto expect_named = [&](const auto& spoil, const char* what, const char* where) {
    Solution spoilt = whole;
    spoil(spoilt);
    EXPECT_THAT([&] { check_finite(spoilt); },
                ThrowsMessage<std::runtime_error>(testing::AllOf(HasSubstr(what), HasSubstr(where))));
  };
  expect_named([](Solution& s) { s.upwelling_flux[2 * 12 + 5] = static_cast<float>(nan); }, "upwelling_flux",
               "at 2 m, column (1, 1)");
  expect_named([](Solution& s) { s.absorbed_power[12 + 11] = HUGE_VALF; }, "absorbed_power",
               "in level 1, column (3, 2)");
  expect_named([](Solution& s) { s.actinic_flux[0] = static_cast<float>(nan); }, "actinic_flux", "in level 0");
  expect_named([](Solution& s) { s.profile_direct_flux[3] = nan; }, "profile/direct_flux", "at 3 m");
  expect_named([](Solution& s) { s.ledger.residual = nan; }, "energy_residual", "nan");
  expect_named([](Solution& s) { s.report.estimated_error = -HUGE_VAL; }, "estimated_error", "-inf");
}

// A fisheye's corners look nowhere.
TEST(SolveLimits, PixelsThatLookNowhereAreNoFault) {
  Solution solution = solve(cloudy(), quick());
  const Camera eye = make_camera("sky", Camera::Projection::fisheye, {{1, 1, 0}, {1, 1, 1}, {0, 1, 0}}, 3., 8, 8);
  solution.camera_images.push_back({eye, std::vector<float>(64, 0.F)});
  solution.camera_images[0].radiance[0] = static_cast<float>(nan);
  EXPECT_NO_THROW(check_finite(solution));
  solution.camera_images[0].radiance[8 * 4 + 3] = static_cast<float>(nan);
  EXPECT_THAT([&] { check_finite(solution); }, ThrowsMessage<std::runtime_error>(HasSubstr("at pixel (3, 4)")));
}

// Few cells are solved by one thread.
TEST(SolveLimits, ASolveLeavesTheNumberOfThreadsOfItsHost) {
  omp_set_num_threads(3);
  solve(cloudy(), quick());
  EXPECT_EQ(omp_get_max_threads(), 3);
}

}  // namespace
}  // namespace cloudbow
