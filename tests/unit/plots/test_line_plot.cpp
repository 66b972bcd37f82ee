#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "cloudbow/core/error.hpp"
#include "plots/line_plot.hpp"

namespace cloudbow {
namespace {

constexpr PlotColour black{0, 0, 0}, white{255, 255, 255}, red{255, 0, 0};

double ink(const PlotCanvas& canvas) {
  double sum = 0;
  for (int y = 0; y < canvas.height(); ++y) {
    for (int x = 0; x < canvas.width(); ++x) sum += (255 - canvas.colour_at(x, y)[1]) / 255.0;
  }
  return sum;
}

TEST(PlotCanvas, ALineCoversLengthTimesWidth) {
  for (const double width : {0.5, 1.0, 3.0}) {
    PlotCanvas canvas(300, 200);
    const std::vector<PlotPoint> line = {{20.3, 30.7}, {260.1, 150.2}};
    canvas.line(line, {black, width, {}, 1});
    const double length = std::hypot(239.8, 119.5);
    // round ends: about another width; thin lines are paler
    EXPECT_NEAR(ink(canvas), (length + width) * width, 0.04 * length * width);
  }
}

TEST(PlotCanvas, ACornerIsNotDrawnTwice) {
  PlotCanvas canvas(100, 100);
  const std::vector<PlotPoint> line = {{10, 50.5}, {90, 50.5}, {10, 50.5}};
  canvas.line(line, {black, 5, {}, 0.5});
  EXPECT_NEAR(canvas.colour_at(50, 50)[0], 127, 1);
}

TEST(PlotCanvas, DashesLeaveTheGapsBlank) {
  PlotCanvas canvas(120, 20);
  const std::vector<PlotPoint> line = {{10, 10.5}, {110, 10.5}};
  canvas.line(line, {black, 1, {10, 10}, 1});
  EXPECT_EQ(canvas.colour_at(15, 10), black);
  EXPECT_EQ(canvas.colour_at(25, 10), white);
  EXPECT_EQ(canvas.colour_at(35, 10), black);
}

TEST(PlotCanvas, NothingIsDrawnOutsideTheClip) {
  PlotCanvas canvas(100, 100);
  const std::vector<PlotPoint> line = {{-1e9, -1e9}, {1e9, 1e9}};
  canvas.line(line, {red, 3, {}, 1}, {40, 40, 60, 60});
  EXPECT_EQ(canvas.colour_at(50, 50), red);
  EXPECT_EQ(canvas.colour_at(30, 30), white);
  EXPECT_EQ(canvas.colour_at(70, 70), white);
}

TEST(PlotCanvas, TextLiesWhereItsAnchorSays) {
  const auto columns_with_ink = [](TextAnchor anchor) {
    PlotCanvas canvas(200, 40);
    canvas.text("HHHH", {100, 20}, 14, anchor);
    int first = 200, last = -1;
    for (int x = 0; x < 200; ++x) {
      for (int y = 0; y < 40; ++y) {
        if (canvas.colour_at(x, y) == white) continue;
        first = std::min(first, x);
        last = x;
      }
    }
    return std::pair(first, last);
  };
  const double width = PlotCanvas::text_width("HHHH", 14);
  EXPECT_NEAR(columns_with_ink(TextAnchor::left).first, 100, 2);
  EXPECT_NEAR(columns_with_ink(TextAnchor::left).second, 100 + width, 2);
  EXPECT_NEAR(columns_with_ink(TextAnchor::centre).first, 100 - width / 2, 2);
  EXPECT_NEAR(columns_with_ink(TextAnchor::right).second, 100, 2);
  EXPECT_LT(PlotCanvas::text_width("10^{-3}", 14), PlotCanvas::text_width("10-3", 14));
}

TEST(PlotCanvas, TakesAnyBytesAsText) {
  PlotCanvas canvas(100, 40);
  for (const char* text : {"", "^{", "^{}", "_{a", "\xff\xfe", "\xe2", "\u00b0\u03c4"}) canvas.text(text, {5, 20}, 10);
}

TEST(PlotCanvas, WritesThePixels) {
  const auto file = std::filesystem::temp_directory_path() / "cloudbow_test_line_plot.png";
  PlotCanvas canvas(7, 5);
  canvas.fill({2, 1, 3, 2}, red);
  canvas.write_png(file);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_file(&png, file.c_str()), 0);
  png.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> rgb(PNG_IMAGE_SIZE(png));
  ASSERT_NE(png_image_finish_read(&png, nullptr, rgb.data(), 0, nullptr), 0);
  std::filesystem::remove(file);
  ASSERT_EQ(png.width, 7u);
  ASSERT_EQ(png.height, 5u);
  for (int i = 0; i < 35; ++i) {
    EXPECT_EQ(rgb[3 * i], 255);
    EXPECT_EQ(rgb[3 * i + 1], i == 9 ? 0 : 255);
  }
  EXPECT_THROW(canvas.write_png("/nowhere/plot.png"), InputError);
}

TEST(PlotAxis, TicksAreRoundNumbersInsideTheRange) {
  const PlotAxis linear;
  const auto ticks = axis_ticks(linear, {0, 1});
  ASSERT_EQ(ticks.size(), 6u);
  EXPECT_NEAR(ticks[1], 0.2, 1e-15);
  const PlotAxis logarithmic{"", true, {}, {}};
  EXPECT_EQ(axis_ticks(logarithmic, {0.05, 200}), (std::vector<double>{0.1, 1, 10, 100}));
  EXPECT_EQ(axis_ticks(logarithmic, {1, 10}, true).size(), 8u);
}

TEST(PlotAxis, RangeHoldsWhatCanBeShown) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const PlotAxis linear, logarithmic{"", true, {}, {}};
  EXPECT_EQ(axis_range(linear, {0.1, 9.3, nan}), std::pair(0.0, 10.0));
  EXPECT_EQ(axis_range(logarithmic, {0.3, 70, -5, 0}), std::pair(0.1, 100.0));
  EXPECT_EQ(axis_range(logarithmic, {10}), std::pair(10.0, 100.0));
  EXPECT_EQ(axis_range(linear, {nan}), std::pair(0.0, 1.0));
}

TEST(LinePlot, DrawsACurveWhereItsValuesAre) {
  PlotCanvas canvas(400, 300);
  LinePlot plot;
  plot.x.range = plot.y.range = {0, 1};
  plot.legend = LegendPlace::none;
  plot.series = {{"", {0, 1}, {0.5, 0.5}, {red, 3, {}, 1}}};
  draw(canvas, canvas.everything(), plot, 10);
  int rows = 0, centre = 0;
  for (int y = 0; y < 300; ++y) {
    if (canvas.colour_at(250, y) != red) continue;
    ++rows;
    centre += y;
  }
  ASSERT_GE(rows, 2);
  // the middle of the frame: 10 pixels of margin above, 26 below
  EXPECT_NEAR(static_cast<double>(centre) / rows, (10 + 300 - 26) / 2.0, 1.5);
}

TEST(LinePlot, BreaksTheLineWhereNothingCanBeShown) {
  PlotCanvas canvas(400, 300);
  LinePlot plot;
  plot.x.range = {0, 4};
  plot.y = {"", true, std::pair(0.1, 10.0), {}};
  plot.legend = LegendPlace::none;
  plot.series = {{"", {0, 1, 2, 3, 4}, {1, 1, -1, 1, 1}, {red, 3, {}, 1}}};
  draw(canvas, canvas.everything(), plot, 10);
  const auto red_in_column = [&](int x) {
    for (int y = 0; y < 300; ++y) {
      if (canvas.colour_at(x, y) == red) return true;
    }
    return false;
  };
  EXPECT_TRUE(red_in_column(60));
  EXPECT_FALSE(red_in_column(210));
  EXPECT_TRUE(red_in_column(360));
}

TEST(LinePlot, NamesOfPointsStandToTheRightAndInsideTheFrame) {
  for (const double x : {5.0, 10.0}) {  // in the middle, on the right edge
    LinePlot plot;
    plot.x.range = plot.y.range = {0.0, 10.0};
    plot.series = {{"", {x}, {5}, {}, false, 0}};
    PlotCanvas without(400, 300), with(400, 300);
    draw(without, without.everything(), plot, 10);
    plot.series[0].point_label = {"balanced"};
    draw(with, with.everything(), plot, 10);
    int first = with.width(), last = -1;
    for (int px = 0; px < with.width(); ++px) {
      for (int py = 0; py < with.height(); ++py) {
        if (with.colour_at(px, py) == without.colour_at(px, py)) continue;
        first = std::min(first, px);
        last = px;
      }
    }
    EXPECT_NEAR(last - first, PlotCanvas::text_width("balanced", 10), 4);  // side bearings
    EXPECT_LT(last, 400 - 15);                                             // the frame ends 1.5 text sizes inside
    EXPECT_TRUE(x > 5 || first > 200) << first;
  }
}

}  // namespace
}  // namespace cloudbow
