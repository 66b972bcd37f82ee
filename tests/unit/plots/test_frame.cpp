// Frames of plots. Truth: texts lie outside the frame, inside the room that was asked for, and do not touch.
#include <gtest/gtest.h>

#include <cmath>

#include "drawing_test_tools.hpp"
#include "plots/frame.hpp"

namespace cloudbow {
namespace {

bool touch(const PlotBox& a, const PlotBox& b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

TEST(Frame, ValuesAreWhereTheAxesSay) {
  const Frame frame{{.name = "x", .unit = "m"},
                    {.name = "y", .unit = "m", .logarithmic = true},
                    {0, 10},
                    {1, 100},
                    {50, 20, 250, 120}};
  const PlotPoint p = frame.at(2.5, 10);
  EXPECT_DOUBLE_EQ(p.x, 100);
  EXPECT_DOUBLE_EQ(p.y, 70);
}

TEST(Frame, LabelsKeepToTheirRoomAndDoNotTouchFrom1em12To1e12) {
  for (int n = -12; n <= 12; n += 3) {
    for (const double offset : {0.0, -1.0, 0.999}) {
      const double size = 3.3 * std::pow(10, n);
      const PlotAxis axis{.name = "a quantity with a rather long name, of which two lines are made", .unit = "W m-2"};
      const std::pair range{offset * size, size};
      const PlotBox box{200, 100, 350, 220};
      Drawing drawing;
      draw_frame(drawing, {axis, axis, range, range, box});
      draw_axis_beside(drawing, box, axis, range, AxisSide::right);
      const PlotBox outer{box.left - room_beside(axis, range, box.height()), box.top,
                          box.right + room_beside(axis, range, box.height()),
                          box.bottom + room_below(axis, range, box.width())};
      const std::vector<PlotBox> boxes = texts(drawing);
      ASSERT_GE(boxes.size(), 8u);
      for (std::size_t a = 0; a < boxes.size(); ++a) {
        EXPECT_GE(boxes[a].left, outer.left - 0.01) << n;
        EXPECT_LE(boxes[a].right, outer.right + 0.01) << n;
        EXPECT_LE(boxes[a].bottom, outer.bottom + 0.01) << n;
        // Boxes of labels are higher than their figures, and reach into the frame by none of their ink.
        EXPECT_FALSE(touch(boxes[a], {box.left + 1, box.top + 1, box.right - 1, box.bottom - 1})) << n;
        for (std::size_t b = a + 1; b < boxes.size(); ++b) {
          const PlotBox& other = boxes[b];
          EXPECT_FALSE(touch(boxes[a], {other.left, other.top + 0.2 * other.height(), other.right,
                                        other.bottom - 0.2 * other.height()}))
              << n << ' ' << offset;
        }
      }
    }
  }
}

TEST(Frame, TitlesStayInsideTheirWidth) {
  std::string title = "Fair-weather cumulus";
  for (int n = 0; n < 7; ++n) {
    Drawing drawing;
    const double height = draw_title(drawing, title, {200, 10}, 300);
    const auto& text = std::get<DrawnText>(drawing.shapes.front());
    const PlotBox box = text_box(text);
    EXPECT_GE(box.left, 50 - 0.5);
    EXPECT_LE(box.right, 350 + 0.5);
    EXPECT_DOUBLE_EQ(box.height(), height);
    EXPECT_LE(height, 3 * 1.3 * figure_title_size);  // three lines
    EXPECT_GE(text.size, 6);                         // legible
    title += title;
  }
  Drawing none;
  EXPECT_EQ(draw_title(none, "", {0, 0}, 100), 0);
  EXPECT_TRUE(none.shapes.empty());
}

}  // namespace
}  // namespace cloudbow
