#include <gtest/gtest.h>

#include <cmath>

#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow {
namespace {

double power_integral(const GaussLegendre& rule, int power) {
  double sum = 0;
  for (std::size_t i = 0; i < rule.node.size(); ++i) sum += rule.weight[i] * std::pow(rule.node[i], power);
  return sum;
}

TEST(GaussLegendre, HasTheClosedFormOfFewNodes) {
  EXPECT_EQ(make_gauss_legendre(1).node[0], 0);
  EXPECT_EQ(make_gauss_legendre(1).weight[0], 2);
  EXPECT_DOUBLE_EQ(make_gauss_legendre(2).node[1], 1 / std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(make_gauss_legendre(3).node[2], std::sqrt(0.6));
  EXPECT_DOUBLE_EQ(make_gauss_legendre(3).weight[1], 8.0 / 9);
}

TEST(GaussLegendre, IntegratesPowersUpToTwiceTheCount) {
  for (const int count : {1, 2, 3, 5, 8, 9, 32}) {
    const GaussLegendre rule = make_gauss_legendre(count);
    for (int power = 0; power < 2 * count; ++power) {
      EXPECT_NEAR(power_integral(rule, power), power % 2 ? 0 : 2.0 / (power + 1), 1e-14) << count << ' ' << power;
    }
  }
  const double missed = 2.0 / 11 - power_integral(make_gauss_legendre(5), 10);
  EXPECT_GT(missed, 1e-4);  // one power more is beyond it: 2^11 5!^4 / (11 10!^3) times 10! = .0029
}

TEST(GaussLegendre, StaysAccurateForManyNodes) {
  const GaussLegendre rule = make_gauss_legendre(512);
  EXPECT_NEAR(power_integral(rule, 0), 2, 1e-12);
  EXPECT_NEAR(power_integral(rule, 1000), 2.0 / 1001, 1e-13);
  for (std::size_t i = 1; i < rule.node.size(); ++i) EXPECT_LT(rule.node[i - 1], rule.node[i]);
}

}  // namespace
}  // namespace cloudbow
