// Refinement of clouds. Truth: the mean of each voxel; fields that are linear or constant; a voxel computed by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "cloud_test_tools.hpp"
#include "cloudbow/medium/cloud_refinement.hpp"

namespace cloudbow {
namespace {

/// [voxel] means over the parts.
std::vector<double> voxel_means(const CloudField& refined, int factor) {
  const auto [nx, ny, nz] = refined.cells;
  const int cx = nx / factor, cy = ny / factor;
  std::vector<double> mean(static_cast<std::size_t>(cx) * cy * (nz / factor), 0.);
  const std::vector<float> parts = to_dense(refined);
  for (std::size_t n = 0; n < parts.size(); ++n) {
    const std::size_t i = n % nx, j = n / nx % ny, k = n / nx / ny;
    mean[(k / factor * cy + j / factor) * cx + i / factor] += parts[n] / std::pow(factor, 3);
  }
  return mean;
}

CloudField field_of(std::array<int, 3> cells, const std::vector<float>& values) {
  return make_cloud_field(cells, {30, 20, 10}, {5, 6, 7}, values, "liquid_water_content");
}

std::vector<float> random_values(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> share(0, 1);
  std::vector<float> values(count);
  for (float& value : values) value = share(random) < .4F ? 0 : std::pow(10.F, -4 * share(random));
  return values;
}

TEST(CloudRefinement, KeepsTheMeanOfEachVoxelAndClearVoxels) {
  const std::vector<float> values = random_values(7 * 5 * 4);
  const CloudField field = field_of({7, 5, 4}, values);
  for (int factor = least_refinement; factor <= largest_refinement; ++factor) {
    for (const bool periodic : {false, true}) {
      const CloudField refined = refine_cloud(field, factor, periodic);
      EXPECT_EQ(refined.cells, (std::array<int, 3>{7 * factor, 5 * factor, 4 * factor}));
      const std::vector<double> mean = voxel_means(refined, factor);
      for (std::size_t n = 0; n < values.size(); ++n)
        EXPECT_NEAR(mean[n], values[n], 1e-7 * values[n]) << "values are stored as float";
      EXPECT_GE(*std::ranges::min_element(refined.value), 0);
      EXPECT_EQ(refined.active_voxels(), field.active_voxels() * factor * factor * factor);
    }
  }
}

TEST(CloudRefinement, CoversTheSameBox) {
  const CloudField field = field_of({2, 1, 1}, {1, 2});
  const CloudField refined = refine_cloud(field, 4, false);
  EXPECT_EQ(refined.quantity, "liquid_water_content");
  EXPECT_EQ(refined.min_m, field.min_m);
  for (int axis = 0; axis < 3; ++axis) EXPECT_DOUBLE_EQ(refined.max_m(axis), field.max_m(axis));
}

TEST(CloudRefinement, ConstantStaysConstant) {
  const CloudField field = field_of({3, 2, 2}, std::vector<float>(12, .3F));
  for (const int factor : {2, 3, 8}) {
    for (const bool periodic : {false, true}) {
      for (const float value : refine_cloud(field, factor, periodic).value) EXPECT_EQ(value, .3F);
    }
  }
}

// Inside a field that is linear the parts have the values of the line: at the centres of parts -3/8, -1/8, 1/8, 3/8.
TEST(CloudRefinement, LinearStaysLinearInside) {
  const CloudField field = field_of({5, 1, 1}, {1, 2, 3, 4, 5});
  const std::vector<float> row = to_dense(refine_cloud(field, 4, false));
  for (std::size_t n = 4; n < 16; ++n) EXPECT_FLOAT_EQ(row[n], 1 + (static_cast<float>(n) - 1.5F) / 4);
}

// The voxel 2 between 0 and 4 has parts 3/4 of 2 + 1/4 of 0 and 3/4 of 2 + 1/4 of 4, whose mean is 2. The last voxel
// has 3.5 and 4, or 3.5 and 3 if the first one is beside it. A factor makes their mean 4.
TEST(CloudRefinement, ByHand) {
  const CloudField field = field_of({3, 1, 1}, {0, 2, 4});
  const auto row = [&field](bool periodic) {
    const std::vector<float> all = to_dense(refine_cloud(field, 2, periodic));
    return std::vector<float>(all.begin(), all.begin() + 6);
  };
  const std::vector<float> open = row(false), closed = row(true);
  for (std::size_t n = 0; n < 4; ++n) EXPECT_FLOAT_EQ(open[n], (std::vector<float>{0, 0, 1.5F, 2.5F}[n]));
  EXPECT_FLOAT_EQ(open[4], 3.5F * 4 / 3.75F);
  EXPECT_FLOAT_EQ(open[5], 4 * 4 / 3.75F);
  EXPECT_FLOAT_EQ(closed[4], 3.5F * 4 / 3.25F);
  EXPECT_FLOAT_EQ(closed[5], 3 * 4 / 3.25F);
}

// Axes are alike: the field with x, y, z exchanged gives the parts with x, y, z exchanged.
TEST(CloudRefinement, AxesAreAlike) {
  const std::vector<float> values = random_values(27);
  std::vector<float> exchanged(27);
  const auto place = [](int i, int j, int k, int n) { return static_cast<std::size_t>((k * n + j) * n + i); };
  for (int n = 0; n < 27; ++n) exchanged[place(n / 3 % 3, n / 9, n % 3, 3)] = values[place(n % 3, n / 3 % 3, n / 9, 3)];
  const std::vector<float> one = to_dense(refine_cloud(field_of({3, 3, 3}, values), 2, false));
  const std::vector<float> other = to_dense(refine_cloud(field_of({3, 3, 3}, exchanged), 2, false));
  for (int n = 0; n < 216; ++n)
    EXPECT_FLOAT_EQ(other[place(n / 6 % 6, n / 36, n % 6, 6)], one[place(n % 6, n / 6 % 6, n / 36, 6)]);
}

TEST(CloudRefinement, OtherQuantitiesAreThoseOfTheVoxel) {
  const CloudField field = field_of({2, 1, 2}, {1, 0, 2, 3});
  const CloudField refined = refine_cloud(field, 2, false);
  const std::vector<float> radius = values_of_parts(field, refined, 2, std::vector<float>{8, 9, 10});
  ASSERT_EQ(radius.size(), refined.value.size());
  EXPECT_TRUE(std::ranges::all_of(radius.begin(), radius.begin() + 8, [](float r) { return r == 8; }));
  EXPECT_EQ((std::vector<float>(radius.end() - 4, radius.end())), (std::vector<float>{9, 9, 10, 10}));
}

}  // namespace
}  // namespace cloudbow
