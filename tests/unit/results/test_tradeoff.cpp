// Errors and fronts. Truth: closed forms, the definition of a Pareto front.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/results/tradeoff.hpp"

namespace cloudbow {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double na_n = std::numeric_limits<double>::quiet_NaN();

BoundaryResult two_columns() { return {"truth.h5", {50, 150}, {25}, {}, {{0.5, 0.375, {1, 3}, {2, 6}}}, {}}; }

TEST(ParetoFront, OfPointsInAPlane) {
  const auto front = [](std::vector<double> cost, std::vector<double> error) { return pareto_front(cost, error); };
  EXPECT_THAT(front({1, 2, 3, 4}, {8, 4, 2, 1}), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(front({1, 2, 3, 4}, {4, 5, 1, 1}), ElementsAre(0, 2));
  EXPECT_THAT(front({4, 3, 2, 1}, {1, 2, 4, 8}), ElementsAre(3, 2, 1, 0));
  EXPECT_THAT(front({1, 1, 2}, {5, 3, 3}), ElementsAre(1));
  EXPECT_THAT(front({1, 1}, {3, 3}), ElementsAre(0));
  EXPECT_THAT(front({1, 2, 3}, {infinite, 0, na_n}), ElementsAre(1));
  EXPECT_THAT(front({}, {}), ElementsAre());
}

TEST(ParetoFront, IsWhatNoOtherPointBeats) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> few(0, 9);  // many ties
  for (int repeat = 0; repeat < 200; ++repeat) {
    std::vector<double> cost, error;
    for (int n = 0; n < 12; ++n) {
      cost.push_back(few(random));
      error.push_back(few(random));
    }
    std::vector<std::size_t> unbeaten;
    for (std::size_t i = 0; i < cost.size(); ++i) {
      bool beaten = false;
      for (std::size_t j = 0; j < cost.size(); ++j) {
        const bool no_worse = cost[j] <= cost[i] && error[j] <= error[i];
        const bool equal = cost[j] == cost[i] && error[j] == error[i];
        beaten = beaten || (no_worse && (!equal || j < i));
      }
      if (!beaten) unbeaten.push_back(i);
    }
    EXPECT_THAT(pareto_front(cost, error), testing::UnorderedElementsAreArray(unbeaten));
  }
}

TEST(FluxErrors, InClosedForm) {
  const BoundaryResult truth = two_columns();
  BoundaryResult result = truth;
  result.fluxes[0] = {0.53125, 0.3125, {2, 4}, {2, 0}};
  const FluxErrors errors = flux_errors(result, truth);
  EXPECT_DOUBLE_EQ(errors.domain, 6.25);  // transmittance is farther off than reflectance
  EXPECT_DOUBLE_EQ(errors.up, 50);        // 1 / 2
  EXPECT_DOUBLE_EQ(errors.down, 100 * std::sqrt(18) / 4);
}

TEST(FluxErrors, OfAResultAgainstItselfAreZero) {
  BoundaryResult truth = two_columns();
  truth.fluxes[0].down_at_bottom = {0, 0};  // nothing comes through: no division of 0 by 0
  const FluxErrors errors = flux_errors(truth, truth);
  EXPECT_EQ(errors.domain, 0);
  EXPECT_EQ(errors.up, 0);
  EXPECT_EQ(errors.down, 0);
}

TEST(FluxErrors, OfASpectrumAreTheLargest) {
  BoundaryResult truth = two_columns();
  truth.wavelengths_um = {0.5, 0.6};
  truth.fluxes.push_back(truth.fluxes[0]);
  BoundaryResult result = truth;
  result.fluxes[0].reflectance += 0.25;
  result.fluxes[1].up_at_top = {2, 4};
  const FluxErrors errors = flux_errors(result, truth);
  EXPECT_DOUBLE_EQ(errors.domain, 25);
  EXPECT_DOUBLE_EQ(errors.up, 50);
  EXPECT_EQ(errors.down, 0);
}

TEST(FluxErrors, NeedTheSameColumnsAndWavelengths) {
  const BoundaryResult truth = two_columns();
  BoundaryResult other = truth;
  other.x_m = {50, 150, 250};
  EXPECT_THAT([&] { flux_errors(other, truth); }, ThrowsMessage<InputError>(HasSubstr("2 x 1 columns")));
  other = truth;
  other.y_m = {75};
  EXPECT_THAT([&] { flux_errors(other, truth); }, ThrowsMessage<InputError>(HasSubstr("truth.h5")));
  other = truth;
  other.wavelengths_um = {0.5};
  EXPECT_THAT([&] { flux_errors(other, truth); }, ThrowsMessage<InputError>(HasSubstr("wavelengths")));
}

}  // namespace
}  // namespace cloudbow
