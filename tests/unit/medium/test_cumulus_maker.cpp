// Fields of cumulus. Truth: the cover asked for, and how such clouds are described.
#include <algorithm>
#include <numeric>

#include "cloud_test_tools.hpp"
#include "cloudbow/medium/cloud_makers.hpp"
#include "maker_test_tools.hpp"

namespace cloudbow {
namespace {

TEST(CloudMakers, CumulusHasTheCoverAskedFor) {
  for (const double asked : {0.05, 0.2, 0.5}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      auto cumulus = options("cumulus", {64, 64, 32});
      cumulus.cover = asked;
      cumulus.seed = seed;
      // A column more or less: the cover is reached by moving the clouds' surface.
      EXPECT_NEAR(cover(column_depths(make_cloud(cumulus))), asked, 1.0 / 4096) << "seed " << seed;
    }
  }
}

TEST(CloudMakers, CumulusStandsOnOneBaseAndGetsDenserUpwards) {
  auto cumulus = options("cumulus", {96, 96, 48});
  cumulus.base_m = 500;
  const auto dense = to_dense(make_cloud(cumulus));
  constexpr std::size_t level = 96 * 96;
  std::vector<double> densest(48, 0.0);
  std::size_t at_base = 0;
  std::size_t cloudy = 0;
  for (std::size_t column = 0; column < level; ++column) {
    bool any = false;
    for (std::size_t k = 0; k < 48; ++k) {
      const double value = dense[k * level + column];
      densest[k] = std::max(densest[k], value);
      any = any || value > 0;
    }
    cloudy += any ? 1 : 0;
    at_base += dense[20 * level + column] > 0 ? 1 : 0;
  }
  for (std::size_t k = 0; k < 20; ++k) EXPECT_EQ(densest[k], 0);
  EXPECT_GT(static_cast<double>(at_base), 0.6 * static_cast<double>(cloudy));
  // Adiabatic cores: between 12.5 and 212.5 m above the base undiluted liquid water grows 17-fold, its power
  // 2/3 6.6-fold; dilution and fluctuations of 35 % leave at least half of that.
  EXPECT_GT(densest[28], 3 * densest[20]);
  // Cores of real cumulus reach 60 to 100 per km.
  const double strongest = *std::max_element(densest.begin(), densest.end());
  EXPECT_GT(strongest, 0.05);
  EXPECT_LT(strongest, 0.15);
}

/// Number of columns in each cloud: columns that touch at a side, around the domain's edges too.
std::vector<int> cloud_areas(const std::vector<double>& depths, int nx, int ny) {
  std::vector<bool> seen(depths.size(), false);
  std::vector<int> areas;
  for (std::size_t start = 0; start < depths.size(); ++start) {
    if (seen[start] || depths[start] == 0) continue;
    std::vector<std::size_t> open = {start};
    seen[start] = true;
    int area = 0;
    while (!open.empty()) {
      const auto column = static_cast<int>(open.back());
      open.pop_back();
      ++area;
      const int i = column % nx;
      const int j = column / nx;
      for (const auto& [a, b] : {std::pair((i + 1) % nx, j), std::pair((i + nx - 1) % nx, j),
                                 std::pair(i, (j + 1) % ny), std::pair(i, (j + ny - 1) % ny)}) {
        const auto next = static_cast<std::size_t>(b * nx + a);
        if (seen[next] || depths[next] == 0) continue;
        seen[next] = true;
        open.push_back(next);
      }
    }
    areas.push_back(area);
  }
  std::sort(areas.begin(), areas.end());
  return areas;
}

TEST(CloudMakers, CumulusIsAPopulationOfSeparateCloudsOfManySizes) {
  const auto areas = cloud_areas(column_depths(make_cloud(options("cumulus", {128, 128, 64}))), 128, 128);
  const int total = std::accumulate(areas.begin(), areas.end(), 0);
  EXPECT_GE(areas.size(), 15U);
  EXPECT_LT(areas.back(), total / 2) << "one cloud must not be the field";
  // A power law steeper than -1: most clouds are small, most of the area is in the large.
  EXPECT_LT(areas[areas.size() / 2], areas.back() / 10);
  EXPECT_GT(std::accumulate(areas.end() - static_cast<std::ptrdiff_t>(areas.size() / 4), areas.end(), 0), total / 2);
}

}  // namespace
}  // namespace cloudbow
