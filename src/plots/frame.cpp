#include "plots/frame.hpp"

#include <algorithm>
#include <cmath>

#include "plots/figure_text.hpp"

namespace cloudbow {

namespace {

constexpr PlotColour frame_colour{60, 60, 60}, grid_colour{222, 222, 222}, minor_grid_colour{240, 240, 240};
constexpr double line_width = 0.7, grid_width = 0.5;
constexpr double tick_length = 3.5, label_gap = 3, title_gap = 5;
constexpr int title_lines = 3, axis_title_lines = 2;
constexpr double least_text_size = 6.5;

DrawnText label_text(const std::string& markup) {
  return {.markup = markup, .place = {0, 0}, .size = figure_text_size};
}

double label_height() { return measure_text(label_text("0")).height; }

double widest(const AxisText& text) {
  double width = 0;
  for (const std::string& label : text.label) width = std::max(width, measure_text(label_text(label)).width);
  return width;
}

/// The title of an axis, in as many lines as a length needs.
DrawnText axis_title(const std::string& markup, double length) {
  DrawnText title = label_text(markup);
  title.anchor = TextAnchor::centre;
  title.max_width = std::max(length, 40.);
  fit_text(title, axis_title_lines, least_text_size);
  return title;
}

double axis_title_height(const std::string& markup, double length) {
  return markup.empty() ? 0 : title_gap + measure_text(axis_title(markup, length)).height;
}

/// Draws a label if it does not touch the one before it.
class LabelRow {
 public:
  explicit LabelRow(Drawing& drawing) : drawing_(drawing) {}

  /// @param low, high what the label covers along the axis
  void add(DrawnText label, double low, double high, double gap) {
    if (any_ && low < high_ + gap && high > low_ - gap) return;
    any_ = true;
    low_ = low;
    high_ = high;
    drawing_.add(std::move(label));
  }

 private:
  Drawing& drawing_;
  bool any_ = false;
  double low_ = 0, high_ = 0;
};

}  // namespace

double room_below(const PlotAxis& axis, std::pair<double, double> range, double length) {
  return tick_length + label_gap + label_height() + axis_title_height(axis_text(axis, range).title, length);
}

double room_beside(const PlotAxis& axis, std::pair<double, double> range, double length) {
  const AxisText text = axis_text(axis, range);
  return tick_length + label_gap + widest(text) + axis_title_height(text.title, length);
}

double overhang(const PlotAxis& axis, std::pair<double, double> range) {
  const AxisText text = axis_text(axis, range);
  return text.label.empty() ? 0 : measure_text(label_text(text.label.back())).width / 2;
}

void draw_grid(Drawing& drawing, const Frame& frame) {
  const auto lines = [&](bool minor, const PlotColour& colour) {
    for (const double x : axis_ticks(frame.x, frame.x_range, minor)) {
      const double at = frame.at(x, frame.y_range.first).x;
      drawing.add(DrawnLine{{{at, frame.box.top}, {at, frame.box.bottom}}, {colour, grid_width}});
    }
    for (const double y : axis_ticks(frame.y, frame.y_range, minor)) {
      const double at = frame.at(frame.x_range.first, y).y;
      drawing.add(DrawnLine{{{frame.box.left, at}, {frame.box.right, at}}, {colour, grid_width}});
    }
  };
  if (frame.x.logarithmic || frame.y.logarithmic) lines(true, minor_grid_colour);
  lines(false, grid_colour);
}

void draw_axis_below(Drawing& drawing, const PlotBox& box, const PlotAxis& axis, std::pair<double, double> range) {
  const AxisText text = axis_text(axis, range);
  LabelRow row(drawing);
  for (std::size_t n = 0; n < text.tick.size(); ++n) {
    const double x = box.left + axis_fraction(axis, range, text.tick[n]) * box.width();
    drawing.add(DrawnLine{{{x, box.bottom}, {x, box.bottom + tick_length}}, {frame_colour, line_width}});
    DrawnText label = label_text(text.label[n]);
    // By the middle of the capitals: those with exponents are higher.
    label.place = {x, box.bottom + tick_length + label_gap + 0.5 * label_height()};
    label.anchor = TextAnchor::centre;
    const double half = measure_text(label).width / 2;
    row.add(label, x - half, x + half, 0.6 * figure_text_size);
  }
  if (text.title.empty()) return;
  DrawnText title = axis_title(text.title, box.width());
  title.place = {(box.left + box.right) / 2, box.bottom + tick_length + label_gap + label_height() + title_gap};
  title.hold = TextHold::top;
  drawing.add(title);
}

void draw_axis_beside(Drawing& drawing, const PlotBox& box, const PlotAxis& axis, std::pair<double, double> range,
                      AxisSide side) {
  const AxisText text = axis_text(axis, range);
  const double edge = side == AxisSide::right ? box.right : box.left, outwards = side == AxisSide::right ? 1 : -1;
  LabelRow row(drawing);
  const double height = label_height();
  for (std::size_t n = 0; n < text.tick.size(); ++n) {
    const double y = box.bottom - axis_fraction(axis, range, text.tick[n]) * box.height();
    drawing.add(DrawnLine{{{edge, y}, {edge + outwards * tick_length, y}}, {frame_colour, line_width}});
    DrawnText label = label_text(text.label[n]);
    label.place = {edge + outwards * (tick_length + label_gap), y};
    label.anchor = side == AxisSide::right ? TextAnchor::left : TextAnchor::right;
    row.add(label, y - height / 2, y + height / 2, -0.15 * height);  // its box is higher than its figures
  }
  if (text.title.empty()) return;
  DrawnText title = axis_title(text.title, box.height());
  title.turn = TextTurn::upwards;
  title.place = {
      edge + outwards * (tick_length + label_gap + widest(text) + title_gap + measure_text(title).height / 2),
      (box.top + box.bottom) / 2};
  drawing.add(title);
}

void draw_outline(Drawing& drawing, const PlotBox& box) {
  drawing.add(DrawnLine{
      {{box.left, box.top}, {box.right, box.top}, {box.right, box.bottom}, {box.left, box.bottom}, {box.left, box.top}},
      {frame_colour, line_width}});
}

void draw_frame(Drawing& drawing, const Frame& frame) {
  draw_outline(drawing, frame.box);
  draw_axis_below(drawing, frame.box, frame.x, frame.x_range);
  draw_axis_beside(drawing, frame.box, frame.y, frame.y_range, AxisSide::left);
}

double draw_title(Drawing& drawing, const std::string& title, PlotPoint top_centre, double width, double size) {
  if (title.empty()) return 0;
  DrawnText text{.markup = plain_text(title),
                 .place = top_centre,
                 .size = size,
                 .anchor = TextAnchor::centre,
                 .hold = TextHold::top,
                 .max_width = width};
  fit_text(text, title_lines, std::min(size, least_text_size));
  drawing.add(text);
  return measure_text(text).height;
}

}  // namespace cloudbow
