#include "plots/map_plot.hpp"

#include <algorithm>

namespace cloudbow {

namespace {

constexpr double most_height = 430;  // of the frame
constexpr double bar_thickness = 12, bar_gap = 10;
constexpr double flat = 0.4;  // aspect of maps that are too flat for a scale at their side
constexpr double subtitle_size = 9;

/// A picture of the colours in a row or a column, the last one at the right or on top.
DrawnPicture bar_picture(const std::vector<Rgb>& colours, const PlotBox& box, bool upright) {
  const auto count = static_cast<int>(colours.size());
  DrawnPicture bar{box, upright ? 1 : count, upright ? count : 1, {}};
  for (int n = 0; n < count; ++n) {
    const Rgb& colour = colours[static_cast<std::size_t>(upright ? count - 1 - n : n)];
    bar.rgba.insert(bar.rgba.end(), {colour[0], colour[1], colour[2], 255});
  }
  return bar;
}

/// Sets the box of the frame. Its height breaks the titles along the vertical axes, and their room leaves it its width.
/// So there are two rounds.
void place_frame(MapPlot& plot, double top) {
  Frame& frame = plot.frame;
  const bool scale_at_right = plot.scale && plot.aspect >= flat;
  double height = most_height;
  for (int round = 0; round < 2; ++round) {
    const double left = plot.has_axes ? room_beside(frame.y, frame.y_range, height) : 0;
    double right = plot.has_axes ? overhang(frame.x, frame.x_range) : 0;
    if (scale_at_right) {
      right = std::max(right, bar_gap + bar_thickness + room_beside(plot.scale->axis, plot.scale->range, height));
    } else if (plot.scale) {
      right = std::max(right, overhang(plot.scale->axis, plot.scale->range));
    }
    const double most_width = figure_width - 2 * figure_margin - left - right;
    height = std::min(most_height, most_width * plot.aspect);
    const double width = height / plot.aspect;
    const double start = figure_margin + left + (most_width - width) / 2;
    frame.box = {start, top, start + width, top + height};
  }
}

/// Dark lines in a pale rim, which are seen on all colours.
void draw_pieces(Drawing& drawing, const Frame& frame, const std::vector<OutlinePiece>& pieces) {
  for (const Stroke& stroke : {Stroke{{255, 255, 255}, 1.1}, Stroke{{0, 0, 0}, 0.4}}) {
    for (const OutlinePiece& piece : pieces)
      drawing.add(
          DrawnLine{{frame.at(piece.from_x, piece.from_y), frame.at(piece.to_x, piece.to_y)}, stroke, frame.box});
  }
}

}  // namespace

Drawing map_figure(MapPlot plot) {
  Drawing drawing{.width = figure_width, .title = plot.title};
  const double title_width = figure_width - 2 * figure_margin;
  double top = figure_margin;
  top += draw_title(drawing, plot.title, {figure_width / 2, top}, title_width);
  top += draw_title(drawing, plot.subtitle, {figure_width / 2, top + 1}, title_width, subtitle_size);
  place_frame(plot, top + figure_margin);
  const PlotBox& box = plot.frame.box;
  plot.picture.box = box;
  drawing.add(plot.picture);
  draw_pieces(drawing, plot.frame, plot.outline);
  double bottom = box.bottom;
  if (plot.has_axes) {
    draw_frame(drawing, plot.frame);
    bottom += room_below(plot.frame.x, plot.frame.x_range, box.width());
  } else {
    draw_outline(drawing, box);
  }
  if (plot.scale) {
    const auto& [axis, range, colours] = *plot.scale;
    if (plot.aspect >= flat) {
      const PlotBox bar{box.right + bar_gap, box.top, box.right + bar_gap + bar_thickness, box.bottom};
      drawing.add(bar_picture(colours, bar, true));
      draw_outline(drawing, bar);
      draw_axis_beside(drawing, bar, axis, range, AxisSide::right);
    } else {
      const PlotBox bar{box.left, bottom + bar_gap, box.right, bottom + bar_gap + bar_thickness};
      drawing.add(bar_picture(colours, bar, false));
      draw_outline(drawing, bar);
      draw_axis_below(drawing, bar, axis, range);
      bottom = bar.bottom + room_below(axis, range, bar.width());
    }
  }
  drawing.height = bottom + figure_margin;
  return drawing;
}

}  // namespace cloudbow
