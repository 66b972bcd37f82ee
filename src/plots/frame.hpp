// The frame of a plot: a box with two axes, their ticks and titles. Lengths are points.
#pragma once

#include <string>
#include <utility>

#include "plots/axis.hpp"
#include "plots/drawing.hpp"

namespace cloudbow {

constexpr double figure_text_size = 9;  ///< of labels
constexpr double figure_title_size = 11;
constexpr double figure_margin = 8;  ///< between the rim of a figure and its content
constexpr double figure_width = 450;

struct Frame {
  PlotAxis x, y;
  std::pair<double, double> x_range, y_range;  ///< values at the left and right, lower and upper edge
  PlotBox box{};

  PlotPoint at(double x_value, double y_value) const {
    return {box.left + axis_fraction(x, x_range, x_value) * box.width(),
            box.bottom - axis_fraction(y, y_range, y_value) * box.height()};
  }
};

/// Room that ticks, labels and the title of an axis need below or beside a box. @param length of its edge, by which the
/// title is broken
double room_below(const PlotAxis& axis, std::pair<double, double> range, double length);
double room_beside(const PlotAxis& axis, std::pair<double, double> range, double length);
/// Half the width of the last label, which may stand at the very end of the axis.
double overhang(const PlotAxis& axis, std::pair<double, double> range);

/// Lines from tick to tick, paler ones between decades.
void draw_grid(Drawing& drawing, const Frame& frame);

enum class AxisSide { left, right };

/// Ticks, labels and title of an axis along the lower edge of a box, or one of its sides. Labels that would touch their
/// neighbours are left out.
void draw_axis_below(Drawing& drawing, const PlotBox& box, const PlotAxis& axis, std::pair<double, double> range);
void draw_axis_beside(Drawing& drawing, const PlotBox& box, const PlotAxis& axis, std::pair<double, double> range,
                      AxisSide side);
void draw_outline(Drawing& drawing, const PlotBox& box);
/// The outline and both axes.
void draw_frame(Drawing& drawing, const Frame& frame);

/// A title of plain text above a plot, broken into lines, smaller if it is long. @returns the height used, 0 without
/// title
double draw_title(Drawing& drawing, const std::string& title, PlotPoint top_centre, double width,
                  double size = figure_title_size);

}  // namespace cloudbow
