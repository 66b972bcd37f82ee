// Plots of curves. Truth: points computed by hand from the frame that was drawn.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drawing_test_tools.hpp"
#include "plots/frame.hpp"
#include "plots/line_plot.hpp"

namespace cloudbow {
namespace {

constexpr PlotColour red{255, 0, 0};
constexpr PlotBox page{0, 0, 400, 300};

std::vector<DrawnLine> lines_of(const Drawing& drawing, const PlotColour& colour) {
  std::vector<DrawnLine> lines;
  for (const Shape& shape : drawing.shapes) {
    const auto* line = std::get_if<DrawnLine>(&shape);
    if (line != nullptr && line->stroke.colour == colour) lines.push_back(*line);
  }
  return lines;
}

LinePlot plot_of(PlotSeries series) {
  LinePlot plot;
  plot.x = {.name = "x", .unit = "m", .range = std::pair(0.0, 4.0)};
  plot.y = {.name = "y", .unit = "W m-2", .range = std::pair(0.0, 10.0)};
  plot.series.push_back(std::move(series));
  return plot;
}

TEST(LinePlot, DrawsACurveWhereItsValuesAre) {
  Drawing drawing;
  draw(drawing, page, plot_of({"", {0, 1, 4}, {0, 5, 10}, {red, 1}}));
  const auto lines = lines_of(drawing, red);
  ASSERT_EQ(lines.size(), 1u);
  const PlotBox box = *lines[0].clip;  // the frame
  ASSERT_EQ(lines[0].points.size(), 3u);
  EXPECT_DOUBLE_EQ(lines[0].points[0].x, box.left);
  EXPECT_DOUBLE_EQ(lines[0].points[0].y, box.bottom);
  EXPECT_NEAR(lines[0].points[1].x, box.left + box.width() / 4, 1e-9);
  EXPECT_NEAR(lines[0].points[1].y, (box.top + box.bottom) / 2, 1e-9);
  EXPECT_NEAR(lines[0].points[2].x, box.right, 1e-9);
  EXPECT_NEAR(lines[0].points[2].y, box.top, 1e-9);
}

TEST(LinePlot, BreaksTheLineIfNothingCanBeShown) {
  LinePlot plot = plot_of({"", {0, 1, 2, 3, 4}, {1, 1, -1, 1, 1}, {red, 1}});
  plot.y = {.name = "y", .unit = "1", .logarithmic = true, .range = std::pair(0.1, 10.0)};
  Drawing drawing;
  draw(drawing, page, plot);
  const auto lines = lines_of(drawing, red);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].points.size(), 2u);
  EXPECT_EQ(lines[1].points.size(), 2u);
}

TEST(LinePlot, NamesOfPointsStandToTheRightAndInsideTheFrame) {
  for (const double x : {2.0, 4.0}) {  // in the middle, on the right edge
    PlotSeries series{"", {x}, {5}, {red, 1}, false, 2};
    series.point_label = {"independent-columns"};
    Drawing drawing;
    draw(drawing, page, plot_of(series));
    const auto disc =
        std::ranges::find_if(drawing.shapes, [](const auto& s) { return std::holds_alternative<DrawnDisc>(s); });
    ASSERT_NE(disc, drawing.shapes.end());
    const PlotPoint at = std::get<DrawnDisc>(*disc).centre;
    const PlotBox frame = *std::get<DrawnDisc>(*disc).clip;
    const auto label = std::ranges::find_if(drawing.shapes, [](const auto& s) {
      return std::holds_alternative<DrawnText>(s) && std::get<DrawnText>(s).markup == "independent-columns";
    });
    ASSERT_NE(label, drawing.shapes.end());
    const PlotBox box = text_box(std::get<DrawnText>(*label));
    EXPECT_LT(box.bottom, at.y + 1);
    EXPECT_LE(box.right, frame.right);
    EXPECT_EQ(box.left > at.x, x == 2.0);
  }
}

TEST(LinePlot, NamesOfNearPointsDoNotTouch) {
  PlotSeries series{"", {2, 2.05, 2.1, 1.95}, {9.8, 9.9, 9.7, 9.8}, {red, 1}, false, 2};
  series.point_label = {"independent-columns", "independent-diffuse", "draft", "balanced"};
  Drawing drawing;
  draw(drawing, page, plot_of(series));
  std::vector<PlotBox> boxes;
  for (const Shape& shape : drawing.shapes) {
    const auto* text = std::get_if<DrawnText>(&shape);
    if (text != nullptr && std::ranges::count(series.point_label, text->markup) > 0) boxes.push_back(text_box(*text));
  }
  ASSERT_EQ(boxes.size(), 4u);
  for (std::size_t a = 0; a < boxes.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_TRUE(boxes[a].right <= boxes[b].left || boxes[b].right <= boxes[a].left ||
                  boxes[a].bottom <= boxes[b].top || boxes[b].bottom <= boxes[a].top)
          << a << b;
  }
}

TEST(LinePlot, EverythingIsOnThePage) {
  for (const double size : {1e-12, 1.0, 1e12}) {
    LinePlot plot;
    plot.title = "A title of a scene that is much longer than what has room in one line of such a small plot";
    plot.x = {.name = "CPU time of the solve, of which much has been written", .unit = "s"};
    plot.y = {.name = "error against the reference solution", .unit = "%"};
    plot.series.push_back({"", {0, size}, {-size, 3 * size}, {red, 1}});
    Drawing drawing;
    draw(drawing, page, plot);
    for (const PlotBox& box : texts(drawing)) {
      EXPECT_GE(box.left, page.left - 0.5) << size;
      EXPECT_GE(box.top, page.top - 0.5) << size;
      EXPECT_LE(box.right, page.right + 0.5) << size;
      EXPECT_LE(box.bottom, page.bottom + 0.5) << size;
    }
  }
}

TEST(PolarPlot, AnglesGoCounterClockwiseAndTheRadiusIsTheLogarithm) {
  Drawing drawing;
  draw(drawing, page, PolarPlot{"", {1, 100}, {{"", {0, 90, 180, 270}, {100, 10, 1, 0.5}, {red, 1}}}});
  const auto lines = lines_of(drawing, red);
  ASSERT_EQ(lines.size(), 1u);
  const auto& p = lines[0].points;
  const PlotPoint centre = p[2];  // the least value
  const double rim = p[0].x - centre.x;
  EXPECT_GT(rim, 50);
  EXPECT_NEAR(p[0].y, centre.y, 1e-9);
  EXPECT_NEAR(p[1].x, centre.x, 1e-9);
  EXPECT_NEAR(p[1].y, centre.y - rim / 2, 1e-9);
  EXPECT_NEAR(p[3].y, centre.y, 1e-9);  // below the range counts as its least
}

TEST(Legend, EntriesStandInARowIfTheyFitElseInColumns) {
  std::vector<PlotSeries> series;
  for (const char* name : {"upwelling flux", "downwelling diffuse flux", "direct flux", ""})
    series.push_back({name, {}, {}, {red, 1}});
  const double row = legend_height(400, series);
  EXPECT_NEAR(legend_height(200, series), 3 * row, 1e-9);
  EXPECT_NEAR(legend_height(300, series), 2 * row, 1e-9);
  for (const double width : {60.0, 200.0, 300.0, 400.0}) {
    Drawing drawing;
    draw_legend(drawing, {10, 20}, width, series);
    const auto boxes = texts(drawing);
    ASSERT_EQ(boxes.size(), 3u);
    for (std::size_t n = 0; n < 3; ++n) {
      EXPECT_GE(boxes[n].left, 10);
      EXPECT_LE(boxes[n].right, 10 + width + 0.5) << width;
      EXPECT_LE(boxes[n].bottom, 20 + legend_height(width, series) + 0.5);
      for (std::size_t m = 0; m < n; ++m)
        EXPECT_TRUE(boxes[m].right <= boxes[n].left || boxes[m].bottom <= boxes[n].top + 1) << width;
    }
  }
}

}  // namespace
}  // namespace cloudbow
