// Axes. Truth: round numbers by hand; labels that, read back, are the values of their ticks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "plots/axis.hpp"

namespace cloudbow {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const PlotAxis linear{.name = "v", .unit = "m"}, logarithmic{.name = "v", .unit = "m", .logarithmic = true};

TEST(PlotAxis, TicksAreRoundNumbersInsideTheRange) {
  const auto ticks = axis_ticks(linear, {0, 1});
  ASSERT_EQ(ticks.size(), 6u);
  EXPECT_NEAR(ticks[1], 0.2, 1e-15);
  EXPECT_EQ(axis_ticks(linear, {1, 0}), ticks) << "an axis may run backwards";
  EXPECT_EQ(axis_ticks(logarithmic, {0.05, 200}), (std::vector<double>{0.1, 1, 10, 100}));
  EXPECT_EQ(axis_ticks(logarithmic, {1, 10}, true).size(), 8u);
  EXPECT_LE(axis_ticks(linear, {0.43, 0.43 * (1 + 1e-15)}).size(), 1000u) << "spaced closer than doubles";
}

TEST(PlotAxis, RangeHoldsWhatCanBeShown) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(axis_range(linear, {0.1, 9.3, nan}), std::pair(0.0, 10.0));
  EXPECT_EQ(axis_range(logarithmic, {0.3, 70, -5, 0}), std::pair(0.1, 100.0));
  EXPECT_EQ(axis_range(logarithmic, {10}), std::pair(10.0, 100.0));
  EXPECT_EQ(axis_range(linear, {nan}), std::pair(0.0, 1.0));
  const auto [low, high] = axis_range(linear, {1e12, 1e12});
  EXPECT_LT(low, 1e12);
  EXPECT_GT(high, 1e12);
  EXPECT_LT(axis_range(linear, {0, 0}).first, 0);
}

TEST(PlotAxis, FractionOfBothKinds) {
  EXPECT_DOUBLE_EQ(axis_fraction(linear, {10, 20}, 12.5), 0.25);
  EXPECT_DOUBLE_EQ(axis_fraction(linear, {20, 10}, 12.5), 0.75);
  EXPECT_DOUBLE_EQ(axis_fraction(logarithmic, {1, 100}, 10), 0.5);
}

TEST(PlotAxis, LabelsAreShort) {
  const AxisText usual = axis_text(linear, {0, 1});
  EXPECT_THAT(usual.label, ElementsAre("0.0", "0.2", "0.4", "0.6", "0.8", "1.0"));
  EXPECT_EQ(usual.title, "v [m]");
  EXPECT_THAT(axis_text(linear, {-20, 20}).label, ElementsAre("\u221220", "\u221210", "0", "10", "20"));
  const AxisText small = axis_text(linear, {0, 5e-12});
  EXPECT_THAT(small.label, ElementsAre("0", "1", "2", "3", "4", "5"));
  EXPECT_EQ(small.title, "v [10<sup>\u221212</sup>\u202fm]");
  const AxisText large = axis_text(linear, {0, 3e12});
  EXPECT_THAT(large.label, ElementsAre("0.0", "0.5", "1.0", "1.5", "2.0", "2.5", "3.0"));
  EXPECT_EQ(large.title, "v [10<sup>12</sup>\u202fm]");
  EXPECT_EQ(axis_text(logarithmic, {1e-12, 1e12}).label.front(), "10<sup>\u221212</sup>");
  EXPECT_THAT(axis_text(logarithmic, {2, 6}).label, ElementsAre("2", "3", "4", "5", "6"));
}

/// The number that a label shows.
double number_in(std::string label) {
  if (label.starts_with("\u2212")) label.replace(0, std::string("\u2212").size(), "-");
  return std::stod(label);
}

/// The power of ten in brackets, 0 without.
int power_in(const std::string& title) {
  const auto at = title.find("[10<sup>");
  return at == std::string::npos ? 0 : static_cast<int>(number_in(title.substr(at + 8)));
}

TEST(PlotAxis, LabelsAreTheValuesOfTheirTicksFrom1em12To1e12) {
  for (int n = -12; n <= 12; ++n) {
    for (const double shape : {0.13, 1.0, 7.7}) {
      for (const double start : {0.0, -0.4, 0.95}) {
        const double size = shape * std::pow(10, n);
        const AxisText text = axis_text(linear, {start * size, size});
        ASSERT_GE(text.tick.size(), 3u);
        EXPECT_EQ(std::set(text.label.begin(), text.label.end()).size(), text.label.size()) << n;
        for (std::size_t k = 0; k < text.tick.size(); ++k) {
          const double read = number_in(text.label[k]) * std::pow(10, power_in(text.title));
          EXPECT_NEAR(read, text.tick[k], 1e-9 * size) << text.label[k] << ' ' << text.title;
          EXPECT_LE(text.label[k].size(), 10u) << "a label is as wide as seven digits";
        }
      }
    }
  }
}

TEST(PlotAxis, ACommonPartIsSubtractedByTheTitle) {
  const AxisText text = axis_text(linear, {1361.0000001, 1361.0000009});
  EXPECT_THAT(text.title, HasSubstr("v \u2212 1361.0000002"));
  EXPECT_EQ(number_in(text.label.front()), 0);
  EXPECT_EQ(std::set(text.label.begin(), text.label.end()).size(), text.label.size());
  EXPECT_EQ(power_in(text.title), -9);
}

}  // namespace
}  // namespace cloudbow
