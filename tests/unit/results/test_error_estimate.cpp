// Truth: closed forms. The solutions are made up, so that every distance is known.
#include <gtest/gtest.h>

#include <cmath>

#include "cloudbow/results/error_estimate.hpp"

namespace cloudbow {
namespace {

constexpr double rounding = 1e-6;  // fluxes of columns are floats

/// 3 x 2 columns, two levels, 10 W m-2 in; up and down in units of which the means are 2 and 6.
Solution made_up(double up_offset, double down_offset) {
  Solution solution;
  solution.box.nx = 3;
  solution.box.ny = 2;
  solution.box.z_edge_m = {0, 1};
  solution.flux_level = {0, 1};
  for (int level = 0; level < 2; ++level) {
    for (int c = 0; c < 6; ++c) {
      const double sign = c % 2 == 0 ? 1 : -1;
      solution.upwelling_flux.push_back(static_cast<float>(2 + sign * up_offset));
      solution.downwelling_diffuse_flux.push_back(static_cast<float>(4 + sign * down_offset));
      solution.direct_flux.push_back(2);
    }
  }
  solution.profile_upwelling_flux = {1, 2};
  solution.profile_downwelling_diffuse_flux = {4, 2};
  solution.profile_direct_flux = {2, 8};
  solution.ledger.reflectance = .2;
  solution.ledger.transmittance = .6;
  return solution;
}

double rms(const std::vector<float>& field) {
  double square = 0;
  for (const float value : field) square += static_cast<double>(value) * static_cast<double>(value);
  return std::sqrt(square / static_cast<double>(field.size()));
}

TEST(FluxDistance, OfASolutionToItselfIsZero) {
  const ByFlux distance = flux_distance(made_up(.1, .3), made_up(.1, .3));
  EXPECT_EQ(distance.domain, 0);
  EXPECT_EQ(distance.up, 0);
  EXPECT_EQ(distance.down, 0);
}

TEST(FluxDistance, OfColumnsIsTheirRootMeanSquareOverTheMean) {
  const ByFlux distance = flux_distance(made_up(0, 0), made_up(.1, .3));
  EXPECT_NEAR(distance.up, .1 / 2, rounding);
  EXPECT_NEAR(distance.down, .3 / 6, rounding);
  EXPECT_EQ(distance.domain, 0);
}

TEST(FluxDistance, OfScenesThatEmitIsOfThePowerIncidentAndEmitted) {
  Solution solution = made_up(0, 0), other = made_up(0, 0);
  solution.emits = other.emits = true;
  solution.ledger.power = other.ledger.power = 25;
  other.profile_upwelling_flux[0] += .5;
  EXPECT_NEAR(flux_distance(solution, other).domain, .5 / 25, 1e-12);
}

TEST(FluxDistance, OfTheDomainIsTheLargestOfAnyLevel) {
  Solution other = made_up(0, 0);
  other.profile_upwelling_flux[0] += .5;
  other.ledger.reflectance += .01;
  EXPECT_NEAR(flux_distance(made_up(0, 0), other).domain, .05, 1e-12);
  other.ledger.transmittance -= .07;
  EXPECT_NEAR(flux_distance(made_up(0, 0), other).domain, .07, 1e-12);
}

TEST(FluxDistance, BetweenTheEndsIsTheWorstOfTheOtherPlanes) {
  // Level 0 is off by .1 up, level 1 by .3 down: both planes are ends of the other direction.
  Solution other = made_up(0, 0);
  for (std::size_t c = 0; c < 6; ++c) {
    other.upwelling_flux[c] += .1F;
    other.direct_flux[6 + c] += .3F;
  }
  const ByFlux ends = flux_distance(made_up(0, 0), other);
  EXPECT_EQ(ends.up, 0);
  EXPECT_EQ(ends.down, 0);
  const ByFlux between = flux_distance_between_ends(made_up(0, 0), other);
  EXPECT_NEAR(between.up, .1 / 2, rounding);
  EXPECT_NEAR(between.down, .3 / 6, rounding);
  EXPECT_EQ(between.domain, 0);
}

TEST(FluxDistance, BetweenTheEndsIsThatOfLevelsThatTheOtherHolds) {
  Solution solution = made_up(0, 0);
  solution.flux_level = {0, 1, 2};
  for (auto* field : {&solution.upwelling_flux, &solution.downwelling_diffuse_flux, &solution.direct_flux})
    field->insert(field->begin(), 6, 100.F);  // a level that the other does not hold
  Solution other = made_up(0, 0);
  other.flux_level = {1, 2};
  for (std::size_t c = 0; c < 6; ++c) other.upwelling_flux[c] += .1F;
  EXPECT_NEAR(flux_distance_between_ends(solution, other).up, .1 / 2, rounding);
}

TEST(ErrorEstimate, OfLevelsBetweenTheEndsIsGivenOnlyIfThereAreAny) {
  const ErrorWeights weights{{1, 1, 1}, {1, 1, 1}, {0, 0, 0}};
  const auto three_levels = [](float offset) {
    Solution solution = made_up(0, 0);
    solution.flux_level = {0, 1, 2};
    for (auto* field : {&solution.upwelling_flux, &solution.downwelling_diffuse_flux, &solution.direct_flux})
      field->insert(field->end(), field->begin(), field->begin() + 6);
    for (std::size_t c = 6; c < 12; ++c) solution.upwelling_flux[c] += offset;
    return solution;
  };
  const CoarseSolves off{three_levels(.1F), three_levels(.1F)};
  const ErrorEstimate estimate = estimate_error(three_levels(0), off, weights, false);
  EXPECT_EQ(estimate.up.total(), 0);
  EXPECT_NEAR(estimate.between_ends, 1.5 * .1 / 2, rounding) << "which count 1.5 times";
  EXPECT_NE(error_line(estimate).find("at levels between 7.5 %"), std::string::npos) << error_line(estimate);
  const CoarseSolves at_ends{made_up(.1, .3), made_up(.1, .3)};
  const ErrorEstimate of_two = estimate_error(made_up(0, 0), at_ends, weights, false);
  EXPECT_EQ(of_two.between_ends, 0);
  EXPECT_EQ(error_line(of_two).find("between"), std::string::npos);
}

// Errors that coarse solves on the same cells do not show.
TEST(ErrorEstimate, CountsProbesAsSpatialWhereTheyAreTheLargerPart) {
  CoarseSolves coarse_solves{made_up(.1, .3), made_up(.14, .3), CoarseSolves::Probe{made_up(0, 0), made_up(.2, .12)}};
  const ErrorWeights weights{{1, .5, .5}, {1, 2, 1}, {0, 0, 0}};
  const ErrorEstimate estimate = estimate_error(made_up(0, 0), coarse_solves, weights, false);
  EXPECT_NEAR(estimate.probe_distance.up, .1, rounding);
  EXPECT_NEAR(estimate.up.spatial, .1, rounding) << "for 2 x .02";
  EXPECT_NEAR(estimate.down.spatial, .02, rounding);
  coarse_solves.constant = made_up(.5, .3);
  EXPECT_NEAR(estimate_error(made_up(0, 0), coarse_solves, weights, false).up.spatial, 2 * .2, rounding);
}

TEST(ErrorEstimate, WeighsDistancesAndAddsSquares) {
  Solution solution = made_up(0, 0);
  solution.report.estimated_error = .003;
  const CoarseSolves coarse_solves{made_up(.1, .3), made_up(.14, .3)};
  const ErrorWeights weights{{1, .5, .5}, {1, 2, 1}, {.001, 0, .1}};
  const ErrorEstimate estimate = estimate_error(solution, coarse_solves, weights, false);
  EXPECT_NEAR(estimate.up.angular, .5 * .05, rounding);
  EXPECT_NEAR(estimate.up.spatial, 2 * .02, rounding);
  EXPECT_EQ(estimate.up.iteration, .003);
  EXPECT_NEAR(estimate.up.total(), std::sqrt(.025 * .025 + .04 * .04 + .003 * .003), rounding);
  EXPECT_EQ(estimate.domain.angular, .001) << "the least";
  EXPECT_EQ(estimate.down.angular, .1) << "the least";
  EXPECT_EQ(estimate.columns(), estimate.down.total());
  EXPECT_TRUE(estimate.upwelling_flux_error.empty());
}

TEST(ErrorEstimate, CountsWhatBlocksOfAirLeaveOut) {
  Solution solution = made_up(0, 0);
  const CoarseSolves coarse_solves{made_up(.1, .3), made_up(.14, .3)};
  const ErrorWeights weights{{1, .5, .5}, {1, 2, 1}, {.001, 0, .1}};
  const ErrorEstimate without = estimate_error(solution, coarse_solves, weights, false);
  solution.report.air_error = .003;
  const ErrorEstimate with = estimate_error(solution, coarse_solves, weights, false);
  EXPECT_NEAR(with.up.spatial, std::hypot(without.up.spatial, .003), rounding);
  EXPECT_NEAR(with.down.spatial, std::hypot(without.down.spatial, .003), rounding);
  EXPECT_NEAR(with.domain.spatial, std::hypot(without.domain.spatial, .0003), rounding);
}

TEST(ErrorEstimate, OfSingleColumnsHasTheRootMeanSquareOfTheWhole) {
  Solution solution = made_up(0, 0);
  solution.report.estimated_error = .003;
  const CoarseSolves coarse_solves{made_up(.1, .3), made_up(.14, .35)};
  const ErrorEstimate estimate = estimate_error(solution, coarse_solves, {{1, .5, .5}, {1, 2, 1}, {0, 0, 0}}, true);
  ASSERT_EQ(estimate.upwelling_flux_error.size(), 6u);
  EXPECT_NEAR(rms(estimate.upwelling_flux_error), 2 * estimate.up.total(), rounding);
  EXPECT_NEAR(rms(estimate.downwelling_flux_error), 6 * estimate.down.total(), rounding);
}

TEST(ErrorEstimate, OfSingleColumnsIsLargeWhereCompanionsDiffer) {
  Solution solution = made_up(0, 0);
  solution.box.nx = 6;
  solution.box.ny = 1;
  Solution other = solution;
  other.upwelling_flux[6] += 1;  // at the top, first column; its neighbours share it across the seam
  const ErrorEstimate estimate = estimate_error(solution, {other, other}, {{1, 1, 1}, {1, 1, 1}, {0, 0, 0}}, true);
  const std::vector<float>& field = estimate.upwelling_flux_error;
  EXPECT_GT(field[0], 0);
  EXPECT_EQ(field[0], field[1]);
  EXPECT_EQ(field[0], field[5]);
  EXPECT_EQ(field[3], 0);
}

}  // namespace
}  // namespace cloudbow
