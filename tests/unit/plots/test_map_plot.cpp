// Figures of maps. Truth: nothing leaves the page, whatever numbers and titles are; equal aspect.
#include <gtest/gtest.h>

#include <cmath>

#include "plots/map_plot.hpp"

namespace cloudbow {
namespace {

MapPlot sample_plot(double size, double aspect, const std::string& title) {
  MapPlot plot;
  plot.title = title;
  plot.subtitle = title + " at z = 3000 m";
  plot.frame = {{.name = "x", .unit = "km"}, {.name = "y", .unit = "km"}, {0, size}, {0, aspect * size}, {}};
  plot.aspect = aspect;
  plot.picture = {{}, 1, 1, {1, 2, 3, 255}};
  plot.scale = ColourScale{{.name = "upwelling flux with a long name", .unit = "W m-2 um-1"},
                           {-size, 0.3 * size},
                           {{0, 0, 0}, {255, 255, 255}}};
  return plot;
}

TEST(MapPlot, NothingLeavesThePageWhateverNumbersAndTitlesAre) {
  std::string title = "Cumulus";
  for (int n = -12; n <= 12; n += 2) {
    for (const double aspect : {0.05, 0.25, 1.0, 4.0, 10.0}) {
      for (const bool has_axes : {true, false}) {
        MapPlot plot = sample_plot(1.7 * std::pow(10, n), aspect, title);
        plot.has_axes = has_axes;
        const Drawing drawing = map_figure(plot);
        EXPECT_EQ(drawing.width, figure_width);
        EXPECT_LT(drawing.height, 700);
        for (const Shape& shape : drawing.shapes) {
          if (const auto* text = std::get_if<DrawnText>(&shape)) {
            const PlotBox box = text_box(*text);
            EXPECT_GE(box.left, 0) << text->markup << ' ' << aspect;
            EXPECT_GE(box.top, 0) << text->markup << ' ' << aspect;
            EXPECT_LE(box.right, drawing.width) << text->markup << ' ' << aspect;
            EXPECT_LE(box.bottom, drawing.height) << text->markup << ' ' << aspect;
          }
        }
      }
    }
    title += ", another line of what a scene may have as its title";
  }
}

TEST(MapPlot, TheFrameHasTheAspectOfTheMap) {
  for (const double aspect : {0.1, 0.5, 1.0, 3.0}) {
    const Drawing drawing = map_figure(sample_plot(6.4, aspect, "T"));
    const auto& picture = std::get<DrawnPicture>(drawing.shapes[2]);  // after the titles
    EXPECT_NEAR(picture.box.height(), aspect * picture.box.width(), 1e-9);
    EXPECT_GT(picture.box.width(), 100);
  }
}

TEST(MapPlot, TheScaleShowsItsColoursInTheirOrder) {
  for (const double aspect : {1.0, 0.2}) {  // upright beside the map, below it
    const Drawing drawing = map_figure(sample_plot(6.4, aspect, "T"));
    std::vector<DrawnPicture> pictures;
    for (const Shape& shape : drawing.shapes) {
      if (const auto* picture = std::get_if<DrawnPicture>(&shape)) pictures.push_back(*picture);
    }
    ASSERT_EQ(pictures.size(), 2u);
    const DrawnPicture& bar = pictures[1];
    EXPECT_EQ(bar.width, aspect == 1 ? 1 : 2);
    EXPECT_EQ(bar.rgba[0], aspect == 1 ? 255 : 0);  // the largest value is on top, or at the right
  }
}

}  // namespace
}  // namespace cloudbow
