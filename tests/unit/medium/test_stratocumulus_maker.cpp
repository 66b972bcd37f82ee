// Fields of stratocumulus. Truth: the cover asked for, the spectrum of turbulence and adiabatic columns.
#include <cmath>
#include <complex>

#include "cloud_test_tools.hpp"
#include "cloudbow/medium/cloud_makers.hpp"
#include "maker_test_tools.hpp"

namespace cloudbow {
namespace {

TEST(CloudMakers, StratocumulusHasTheSpectrumOfTurbulence) {
  constexpr int n = 128;
  const auto depths = column_depths(make_cloud(options("stratocumulus", {n, n, 64})));
  std::vector<double> power(n / 2, 0.0);
  for (int j = 0; j < n; ++j) {
    for (int wave = 1; wave < n / 2; ++wave) {
      std::complex<double> sum = 0;
      for (int i = 0; i < n; ++i) {
        sum += std::log(depths[static_cast<std::size_t>(j * n + i)]) *
               std::polar(1.0, 2 * 3.14159265358979 * wave * i / n);
      }
      power[static_cast<std::size_t>(wave)] += std::norm(sum);
    }
  }
  // Least squares of log power over log wave number, between the outer scale (2 waves) and the cells.
  double sx = 0, sy = 0, sxx = 0, sxy = 0, count = 0;
  for (int wave = 6; wave <= 40; ++wave) {
    const double x = std::log(wave);
    const double y = std::log(power[static_cast<std::size_t>(wave)]);
    sx += x, sy += y, sxx += x * x, sxy += x * y, ++count;
  }
  const double slope = (count * sxy - sx * sy) / (count * sxx - sx * sx);
  // 35 powers, each a mean over some 40 independent rows, scatter by 16 %: the slope is known to 0.06; 3 sigma.
  EXPECT_NEAR(slope, -5.0 / 3, 0.18);
}

TEST(CloudMakers, StratocumulusIsAdiabaticAboveAFlatBase) {
  const auto dense = to_dense(make_cloud(options("stratocumulus", {32, 32, 40})));
  constexpr std::size_t level = 32 * 32;
  for (std::size_t column = 0; column < level; ++column) {
    EXPECT_EQ(dense[15 * level + column], 0);
    const double lowest = dense[16 * level + column];
    const double next = dense[17 * level + column];
    ASSERT_GT(lowest, 0);
    // Cell means of z^(2/3): 2^(5/3) - 1 times the lowest, or less if the top lies within.
    if (dense[18 * level + column] > 0) {
      EXPECT_NEAR(next / lowest, std::pow(2.0, 5.0 / 3) - 1, 2 * value_rounding * next / lowest);
    }
  }
}

TEST(CloudMakers, BrokenStratocumulusHasTheCoverAskedFor) {
  auto broken = options("stratocumulus", {64, 64, 24});
  broken.cover = 0.7;
  EXPECT_NEAR(cover(column_depths(make_cloud(broken))), 0.7, 1.0 / 4096);
}

}  // namespace
}  // namespace cloudbow
