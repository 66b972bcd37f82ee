// Means over spectral weights. Truth: integrals of polynomials by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../near_with_report.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/spectral_mean.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;
using Values = std::vector<double>;

double mean_of(const NodeShares& nodes, const Values& value) {
  double sum = 0;
  for (std::size_t n = 0; n < value.size(); ++n) sum += nodes.share[n] * value[n];
  return sum;
}

constexpr double rounding = 1e-13;

TEST(SpectralMean, OfAConstantWeightIsTheAreaOfTheFunction) {
  // f = 0, 3, 1 at 1, 2, 4: area 1.5 + 4 over a length of 3.
  const NodeShares nodes = node_shares(Values{1, 2, 4}, Values{1, 4}, Values{2, 2}, "w");
  EXPECT_NEAR(mean_of(nodes, {0, 3, 1}), 5.5 / 3, rounding);
  EXPECT_EQ(nodes.below, 0);
  EXPECT_EQ(nodes.above, 0);
}

TEST(SpectralMean, OfALinearWeightAndALinearFunctionIsExact) {
  // The integral of x * x over that of x, from 1 to 4, whatever the nodes of both.
  const NodeShares nodes = node_shares(Values{.5, 1.7, 2.2, 6}, Values{1, 3, 4}, Values{1, 3, 4}, "w");
  EXPECT_NEAR(mean_of(nodes, {.5, 1.7, 2.2, 6}), 21 / 7.5, rounding);
}

TEST(SpectralMean, TakesStepsOfTheWeight) {
  // 3 from 0 to 1, nothing to 5, 1 from 5 to 8; the function is x.
  const NodeShares nodes = node_shares(Values{0, 10}, Values{0, 1, 1, 5, 5, 8}, Values{3, 3, 0, 0, 1, 1}, "w");
  EXPECT_NEAR(mean_of(nodes, {0, 10}), (3 * .5 + 3 * 6.5) / 6, rounding);
}

TEST(SpectralMean, GoesOnWithTheEndValues) {
  const NodeShares nodes = node_shares(Values{2, 3}, Values{0, 5}, Values{1, 1}, "w");
  EXPECT_NEAR(nodes.below, .4, rounding);
  EXPECT_NEAR(nodes.above, .4, rounding);
  EXPECT_NEAR(mean_of(nodes, {1, 2}), .4 * 1 + .2 * 1.5 + .4 * 2, rounding);
  const NodeShares one = node_shares(Values{7}, Values{0, 5}, Values{1, 1}, "w");
  EXPECT_NEAR(one.share[0], 1, rounding);
  EXPECT_NEAR(one.below, 1, rounding);
}

TEST(SpectralMean, SharesAreAPartition) {
  Values node, wavenumber, weight;
  for (int n = 0; n < 40; ++n) node.push_back(1 + n * n * .7);
  for (int n = 0; n < 90; ++n) {
    wavenumber.push_back(20 + 11.3 * n);
    weight.push_back(2 + std::sin(n));
  }
  const NodeShares nodes = node_shares(node, wavenumber, weight, "w");
  EXPECT_NEAR(mean_of(nodes, Values(node.size(), 1.0)), 1, rounding);
  for (const double share : nodes.share) EXPECT_GE(share, 0);
}

TEST(SpectralMean, RefusesWeightsThatAreNone) {
  const Values node{1, 2};
  const auto message = [](const char* text) { return ThrowsMessage<InputError>(HasSubstr(text)); };
  EXPECT_THAT([&] { node_shares(node, Values{1, 2}, Values{1}, "w"); }, message("w: weight of another length"));
  EXPECT_THAT([&] { node_shares(node, Values{1}, Values{1}, "w"); }, message("at least 2"));
  EXPECT_THAT([&] { node_shares(node, Values{1, 2}, Values{1, -1}, "w"); }, message("found -1 at 2 cm-1"));
  EXPECT_THAT([&] { node_shares(node, Values{2, 1}, Values{1, 1}, "w"); }, message("descend"));
  EXPECT_THAT([&] { node_shares(node, Values{1, 2}, Values{0, 0}, "w"); }, message("0 everywhere"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { node_shares(node, Values{1, 2}, Values{nan, 1}, "w"); }, message("out of range"));
}

}  // namespace
}  // namespace cloudbow
