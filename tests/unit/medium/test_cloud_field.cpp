#include <gmock/gmock.h>

#include <limits>

#include "cloud_test_tools.hpp"
#include "cloudbow/medium/vdb_file.hpp"

namespace cloudbow {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(CloudField, RowsBecomeSpansInTheOrderOfLevelsThenRows) {
  const CloudField field = make_cloud_field({4, 2, 2}, {1, 1, 1}, {0, 0, 0},
                                            {1, 2, 0, 3,  //
                                             0, 0, 0, 0,  //
                                             0, 4, 5, 6,  //
                                             7, 0, 0, 8},
                                            "extinction");
  EXPECT_THAT(field.value, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
  EXPECT_THAT(field.row_begin, ElementsAre(0, 2, 2, 3, 5));
  ASSERT_EQ(field.spans.size(), 5U);
  const std::vector<std::array<std::uint32_t, 3>> expected = {{0, 2, 0}, {3, 1, 2}, {1, 3, 3}, {0, 1, 6}, {3, 1, 7}};
  for (std::size_t s = 0; s < expected.size(); ++s) {
    EXPECT_EQ(field.spans[s].i, static_cast<int>(expected[s][0]));
    EXPECT_EQ(field.spans[s].n, static_cast<int>(expected[s][1]));
    EXPECT_EQ(field.spans[s].offset, expected[s][2]);
  }
  EXPECT_THAT(to_dense(field), ElementsAre(1, 2, 0, 3, 0, 0, 0, 0, 0, 4, 5, 6, 7, 0, 0, 8));
}

TEST(CloudField, AnEmptyFieldHasNoSpans) {
  const CloudField field = make_cloud_field({3, 2, 1}, {1, 1, 1}, {0, 0, 0}, std::vector<float>(6, 0.0F), "");
  EXPECT_EQ(field.active_voxels(), 0U);
  EXPECT_THAT(field.row_begin, ElementsAre(0, 0, 0));
}

TEST(CloudField, ValuesThatAreNoDensityAreRejectedWithTheirCell) {
  for (const float bad : {-1.0F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    const auto message = message_of([&] { make_cloud_field({2, 2, 1}, {1, 1, 1}, {0, 0, 0}, {0, 0, 1, bad}, ""); });
    EXPECT_THAT(message, HasSubstr("cell (1, 1, 0)"));
  }
}

TEST(CloudSummary, CountsWhatAHandCanCount) {
  // Columns of 10 m cells: (0,0) holds 0.1 + 0.3, (1,1) holds 0.2, two are clear.
  const CloudField field =
      make_cloud_field({2, 2, 2}, {5, 5, 10}, {100, 200, 300}, {0.1F, 0, 0, 0, 0.3F, 0, 0, 0.2F}, "extinction");
  const CloudSummary summary = summarize(field);
  EXPECT_EQ(summary.active_voxels, 3U);
  EXPECT_DOUBLE_EQ(summary.fill, 3.0 / 8);
  EXPECT_DOUBLE_EQ(summary.cover, 0.5);
  constexpr double rounding = 1e-6;  // the values are 32-bit numbers
  EXPECT_NEAR(summary.value.min, 0.1, rounding);
  EXPECT_NEAR(summary.value.mean, 0.2, rounding);
  EXPECT_NEAR(summary.value.max, 0.3, rounding);
  EXPECT_NEAR(summary.column.min, 2, 10 * rounding);
  EXPECT_NEAR(summary.column.mean, 3, 10 * rounding);
  EXPECT_NEAR(summary.column.max, 4, 10 * rounding);
  EXPECT_THAT(summary.domain_max_m, ElementsAre(110, 210, 320));
  EXPECT_THAT(summary.cloud_min_m, ElementsAre(100, 200, 300));
  EXPECT_THAT(summary.cloud_max_m, ElementsAre(110, 210, 320));
}

TEST(CloudSummary, TheBoxOfTheCloudLeavesOutClearAir) {
  std::vector<float> dense(4 * 3 * 2, 0.0F);
  dense[(1 * 3 + 2) * 4 + 1] = 1;
  const CloudSummary summary = summarize(make_cloud_field({4, 3, 2}, {1, 2, 3}, {0, 0, 0}, dense, ""));
  EXPECT_THAT(summary.cloud_min_m, ElementsAre(1, 4, 3));
  EXPECT_THAT(summary.cloud_max_m, ElementsAre(2, 6, 6));
}

}  // namespace
}  // namespace cloudbow
