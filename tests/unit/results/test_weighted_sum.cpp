// Sums over a spectrum. Truth: the sums by hand of made-up solutions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "cloudbow/results/energy_fluxes.hpp"
#include "cloudbow/results/weighted_sum.hpp"

namespace cloudbow {
namespace {

using testing::ElementsAre;

/// One column, two levels; all fluxes and the ledger are multiples of `scale`, its fractions are `fraction`.
Solution solution_of(double scale, double fraction) {
  Solution solution;
  solution.box.z_edge_m = {0, 100, 300};
  solution.sun = Sun{{0, 0, -1}, 10 * scale};
  solution.flux_level = {0, 2};
  const auto value = static_cast<float>(scale);
  solution.upwelling_flux = {value, 2 * value};
  solution.downwelling_diffuse_flux = {3 * value, 0};
  solution.direct_flux = {4 * value, 5 * value};
  solution.profile_upwelling_flux = {scale, 1.5 * scale, 2 * scale};
  solution.profile_downwelling_diffuse_flux = {3 * scale, scale, 0};
  solution.profile_direct_flux = {4 * scale, 4.5 * scale, 5 * scale};
  solution.absorbed_power = {value / 8, value / 16};
  solution.images = {{{"nadir", {0, 0, 1}}, {6 * value}}};
  EnergyLedger& ledger = solution.ledger;
  ledger.power = 10 * scale;
  ledger.incident = 1;
  ledger.reflectance = fraction;
  ledger.transmittance = .5 * fraction;
  ledger.absorptance = .3;
  ledger.surface_absorptance = .7 - fraction;
  SolverReport& report = solution.report;
  report.converged = true;
  report.sweeps = static_cast<int>(10 * scale);
  report.estimated_error = fraction;
  report.gather_rescaling = 1 - .1 * fraction;
  report.seconds_total = scale;
  report.peak_memory_bytes = static_cast<std::size_t>(100 * scale);
  report.air_error = .01 * fraction;
  report.air_block_columns = static_cast<int>(8 * scale);
  return solution;
}

Solution sum_of_two() {
  Solution sum;
  add_weighted(sum, solution_of(1, .2), 2);
  add_weighted(sum, solution_of(3, .6), .5);
  return sum;
}

// 2 * 1 + .5 * 3 = 3.5; all numbers are sums of powers of two, so float has them exactly.
TEST(WeightedSum, FieldsAddUp) {
  const Solution sum = sum_of_two();
  EXPECT_THAT(sum.flux_level, ElementsAre(0, 2));
  EXPECT_THAT(sum.upwelling_flux, ElementsAre(3.5F, 7.F));
  EXPECT_THAT(sum.downwelling_diffuse_flux, ElementsAre(10.5F, 0.F));
  EXPECT_THAT(sum.direct_flux, ElementsAre(14.F, 17.5F));
  EXPECT_THAT(sum.profile_upwelling_flux, ElementsAre(3.5, 5.25, 7));
  EXPECT_THAT(sum.profile_direct_flux, ElementsAre(14, 15.75, 17.5));
  EXPECT_THAT(sum.absorbed_power, ElementsAre(3.5F / 8, 3.5F / 16));
  ASSERT_EQ(sum.images.size(), 1U);
  EXPECT_THAT(sum.images[0].radiance, ElementsAre(21.F));
  EXPECT_EQ(sum.images[0].view.name, "nadir");
  EXPECT_EQ(sum.sun->irradiance, 35);
  EXPECT_TRUE(sum.actinic_flux.empty()) << "was not requested";
}

// Power 2 * 10 and .5 * 30; reflected 20 * .2 + 15 * .6 = 13 W m-2.
TEST(WeightedSum, LedgerIsThatOfAllPower) {
  const Solution sum = sum_of_two();
  constexpr double rounding_of_sums = 1e-13;
  const EnergyFluxes fluxes = energy_fluxes(sum.ledger);
  EXPECT_EQ(sum.ledger.power, 35);
  EXPECT_NEAR(fluxes.incident, 35, 35 * rounding_of_sums);
  EXPECT_NEAR(fluxes.upwelling_top, 13, 13 * rounding_of_sums);
  EXPECT_NEAR(fluxes.downwelling_bottom, 6.5, 6.5 * rounding_of_sums);
  EXPECT_NEAR(fluxes.absorbed, 10.5, 10.5 * rounding_of_sums);
  EXPECT_NEAR(fluxes.surface_absorbed, 20 * .5 + 15 * .1, 12 * rounding_of_sums);
}

TEST(WeightedSum, ReportIsOfTheHardestSolve) {
  const SolverReport report = sum_of_two().report;
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.sweeps, 30);
  EXPECT_EQ(report.estimated_error, .6);
  EXPECT_EQ(report.gather_rescaling, 1 - .1 * .6);
  EXPECT_EQ(report.seconds_total, 4) << "times are not weighted";
  EXPECT_EQ(report.peak_memory_bytes, 300U);
  // 20 and 15 of 35 W m-2 of power, with errors of .002 and .006.
  EXPECT_NEAR(report.air_error, (20 * .002 + 15 * .006) / 35, 1e-15);
  EXPECT_EQ(report.air_block_columns, 8) << "the narrowest";
  Solution other = solution_of(1, .2);
  other.report.converged = false;
  Solution sum = solution_of(1, .2);
  add_weighted(sum, other, 1);
  EXPECT_FALSE(sum.report.converged);
}

TEST(WeightedSum, WeightOneKeepsTheBits) {
  constexpr double odd = 1 / 3.;
  const Solution one = solution_of(odd, odd), dark = [] {
    Solution solution = solution_of(0, 0);
    solution.sun.reset();
    return solution;
  }();
  for (const bool dark_first : {false, true}) {
    Solution sum;
    if (dark_first) add_weighted(sum, dark, 1);
    add_weighted(sum, one, 1);
    if (!dark_first) add_weighted(sum, dark, 1);
    EXPECT_EQ(sum.upwelling_flux, one.upwelling_flux);
    EXPECT_EQ(sum.profile_direct_flux, one.profile_direct_flux);
    EXPECT_EQ(sum.absorbed_power, one.absorbed_power);
    EXPECT_EQ(sum.images[0].radiance, one.images[0].radiance);
    EXPECT_EQ(sum.ledger.power, one.ledger.power);
    EXPECT_EQ(sum.ledger.reflectance, one.ledger.reflectance);
    EXPECT_EQ(sum.ledger.absorptance, one.ledger.absorptance);
    ASSERT_TRUE(sum.sun) << "a g-point without sunlight does not put out the sun";
    EXPECT_EQ(sum.sun->irradiance, one.sun->irradiance);
  }
}

TEST(WeightedSum, OfRadianceFieldsToo) {
  Solution field = solution_of(1, .2);
  field.radiance_field = RadianceField{{{0, 0, 1}}, {}, {{0, 0, 0}}, {8.F}};
  Solution sum;
  add_weighted(sum, field, .25);
  add_weighted(sum, field, .5);
  ASSERT_TRUE(sum.radiance_field);
  EXPECT_THAT(sum.radiance_field->radiance, ElementsAre(6.F));
  EXPECT_THAT([&] { add_weighted(sum, solution_of(1, .2), 1); }, testing::Throws<std::invalid_argument>());
}

TEST(WeightedSum, OtherGridsAreRefused) {
  const auto refused = [](auto change) {
    Solution sum = solution_of(1, .2), other = solution_of(1, .2);
    change(other);
    EXPECT_THROW(add_weighted(sum, other, 1), std::invalid_argument);
  };
  refused([](Solution& other) { other.flux_level = {0, 1}; });
  refused([](Solution& other) { other.upwelling_flux.resize(4); });
  refused([](Solution& other) { other.absorbed_power.clear(); });
  refused([](Solution& other) { other.images.clear(); });
  refused([](Solution& other) { other.images[0].radiance.resize(4); });
  refused([](Solution& other) { other.camera_images.resize(1); });
  refused([](Solution& other) { other.box.z_edge_m[1] = 150; });
  refused([](Solution& other) { other.radiance_field = RadianceField{{{0, 0, 1}}, {}, {{0, 0, 0}}, {8.F}}; });
}

}  // namespace
}  // namespace cloudbow
