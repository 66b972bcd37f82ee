#include "plots/line_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

#include "plots/figure_text.hpp"
#include "plots/frame.hpp"

namespace cloudbow {
namespace {

constexpr PlotColour frame_colour{60, 60, 60}, grid_colour{222, 222, 222};
constexpr double text_size = figure_text_size;

std::pair<double, double> range_over(const LinePlot& plot, const PlotAxis& axis,
                                     std::vector<double> PlotSeries::*values) {
  std::vector<double> all;
  for (const PlotSeries& s : plot.series) all.insert(all.end(), (s.*values).begin(), (s.*values).end());
  return axis_range(axis, all);
}

DrawnText label_text(const std::string& label) { return {.markup = plain_text(label), .place = {0, 0}}; }

/// Puts names beside points, so that they touch neither each other nor the frame.
class PointLabels {
 public:
  PointLabels(Drawing& drawing, const PlotBox& frame) : drawing_(drawing), frame_(frame) {}

  /// Above the point to the right if there is room, because a falling curve leaves it; else on another side.
  void add(PlotPoint at, const std::string& label) {
    DrawnText text = label_text(label);
    const double gap = 0.6 * text_size, up = 1.1 * text_size;
    for (const double lines : {1., -1., 2., -2., 3., -3., 4., -4.}) {
      for (const TextAnchor anchor : {TextAnchor::left, TextAnchor::right}) {
        text.anchor = anchor;
        text.place = {at.x + (anchor == TextAnchor::left ? gap : -gap), at.y - lines * up};
        if (has_room(text_box(text))) {
          put(text);
          return;
        }
      }
    }
    put(text);
  }

 private:
  bool has_room(const PlotBox& box) const {
    return box.left >= frame_.left && box.right <= frame_.right && box.top >= frame_.top &&
           box.bottom <= frame_.bottom && std::ranges::none_of(there_, [&](const PlotBox& other) {
             return box.left < other.right && other.left < box.right && box.top < other.bottom &&
                    other.top < box.bottom;
           });
  }

  void put(const DrawnText& text) {
    there_.push_back(text_box(text));
    drawing_.add(text);
  }

  Drawing& drawing_;
  PlotBox frame_;
  std::vector<PlotBox> there_{};
};

void draw_series(Drawing& drawing, const Frame& frame, const PlotSeries& series, PointLabels& labels) {
  assert(series.x.size() == series.y.size());
  assert(series.point_label.empty() || series.point_label.size() == series.x.size());
  std::vector<PlotPoint> piece;
  const auto finish = [&] {
    for (const PlotPoint& p : piece) {
      if (series.marker_radius > 0) drawing.add(DrawnDisc{p, series.marker_radius, series.stroke.colour, frame.box});
    }
    if (series.has_line && !piece.empty()) drawing.add(DrawnLine{piece, series.stroke, frame.box});
    piece.clear();
  };
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (can_show(frame.x, series.x[i]) && can_show(frame.y, series.y[i])) {
      piece.push_back(frame.at(series.x[i], series.y[i]));
      if (!series.point_label.empty()) labels.add(piece.back(), series.point_label[i]);
    } else {
      finish();
    }
  }
  finish();
}

constexpr double legend_line_length = 2.6;  // length of a line in the legend, in text sizes
constexpr double legend_row = 1.7;          // height of a row, in text sizes
constexpr double legend_gap = 2;            // between columns, in text sizes

double entry_width(const PlotSeries& series) {
  return (legend_line_length + 0.8) * text_size + measure_text(label_text(series.label)).width;
}

/// Locations of the entries: one after the other if they fit into a row, else in columns of equal width.
struct LegendPlan {
  std::vector<PlotPoint> place;  ///< relative to the upper left corner
  double column = 0;             ///< widest entry that has room
  int rows = 0;
};

LegendPlan plan_legend(double width, const std::vector<PlotSeries>& series) {
  std::vector<double> entry;
  for (const PlotSeries& s : series) {
    if (!s.label.empty()) entry.push_back(entry_width(s) + legend_gap * text_size);
  }
  LegendPlan plan;
  const double row = legend_row * text_size, room = width + legend_gap * text_size;
  if (std::accumulate(entry.begin(), entry.end(), 0.0) <= room) {
    double x = 0;
    for (const double length : entry) {
      plan.place.push_back({x, row / 2});
      x += length;
    }
    plan.column = width;
    plan.rows = entry.empty() ? 0 : 1;
    return plan;
  }
  const int columns = std::max(1, static_cast<int>(room / *std::max_element(entry.begin(), entry.end())));
  plan.column = width / columns;
  const auto count = static_cast<int>(entry.size());
  for (int n = 0; n < count; ++n) {
    const int line = n / columns;
    plan.place.push_back({(n % columns) * plan.column, (line + 0.5) * row});
  }
  plan.rows = (count + columns - 1) / columns;
  return plan;
}

void draw_entry(Drawing& drawing, const PlotSeries& series, PlotPoint at, double width) {
  const double length = legend_line_length * text_size;
  if (series.has_line) drawing.add(DrawnLine{{at, {at.x + length, at.y}}, series.stroke});
  if (series.marker_radius > 0)
    drawing.add(DrawnDisc{{at.x + length / 2, at.y}, series.marker_radius, series.stroke.colour});
  DrawnText text = label_text(series.label);
  text.place = {at.x + length + 0.8 * text_size, at.y};
  text.max_width = width - length - 0.8 * text_size;
  text.max_lines = 1;
  drawing.add(text);
}

PlotPoint around(PlotPoint centre, double radius, double angle_deg) {
  const double angle = angle_deg * std::numbers::pi / 180;
  return {centre.x + radius * std::cos(angle), centre.y - radius * std::sin(angle)};
}

std::vector<PlotPoint> circle(PlotPoint centre, double radius) {
  std::vector<PlotPoint> points;
  for (int angle = 0; angle <= 360; angle += 2) points.push_back(around(centre, radius, angle));
  return points;
}

}  // namespace

PlotColour plot_colour(std::size_t index) {
  static constexpr std::array<PlotColour, 8> colours{{{0, 114, 178},
                                                      {213, 94, 0},
                                                      {0, 158, 115},
                                                      {204, 121, 167},
                                                      {230, 159, 0},
                                                      {86, 180, 233},
                                                      {0, 0, 0},
                                                      {240, 228, 66}}};
  return colours[index % colours.size()];
}

void draw(Drawing& drawing, const PlotBox& box, const LinePlot& plot) {
  Frame frame{plot.x, plot.y, range_over(plot, plot.x, &PlotSeries::x), range_over(plot, plot.y, &PlotSeries::y)};
  const double title = draw_title(drawing, plot.title, {(box.left + box.right) / 2, box.top}, box.width());
  const double height = box.height() - title;
  frame.box = {box.left + room_beside(frame.y, frame.y_range, height), box.top + title + 0.8 * text_size,
               box.right - overhang(frame.x, frame.x_range) - 2,
               box.bottom - room_below(frame.x, frame.x_range, box.width())};
  draw_grid(drawing, frame);
  PointLabels labels(drawing, frame.box);
  for (const PlotSeries& series : plot.series) draw_series(drawing, frame, series, labels);
  draw_frame(drawing, frame);
}

void draw(Drawing& drawing, const PlotBox& box, const PolarPlot& plot) {
  const PlotAxis axis{.name = "", .unit = "", .logarithmic = true};
  const double title = draw_title(drawing, plot.title, {(box.left + box.right) / 2, box.top}, box.width());
  const double label = 2.6 * text_size;
  const PlotPoint centre{(box.left + box.right) / 2, (box.top + title + box.bottom) / 2};
  const double rim = std::min(box.width() / 2 - label, (box.height() - title) / 2 - label);

  const auto radius = [&](double value) {
    return rim * axis_fraction(axis, plot.range, std::clamp(value, plot.range.first, plot.range.second));
  };
  for (const double tick : axis_ticks(axis, plot.range))
    drawing.add(DrawnLine{circle(centre, radius(tick)), {grid_colour, 0.5}});
  for (int angle = 0; angle < 360; angle += 30) {
    drawing.add(DrawnLine{{centre, around(centre, rim, angle)}, {grid_colour, 0.5}});
    drawing.add(DrawnText{.markup = fmt::format("{}\u00b0", angle),
                          .place = around(centre, rim + 1.5 * text_size, angle),
                          .anchor = TextAnchor::centre});
  }
  // Below the curves, which they must not hide.
  const AxisText text = axis_text(axis, plot.range);
  for (std::size_t n = 0; n < text.tick.size(); ++n) {
    const double at = radius(text.tick[n]);
    if (at < 0.1 * rim || at > 0.95 * rim) continue;
    DrawnText tick{.markup = text.label[n], .place = around(centre, at, 105), .anchor = TextAnchor::centre};
    const double half = measure_text(tick).width / 2 + 0.2 * text_size;
    drawing.add(DrawnArea{
        {tick.place.x - half, tick.place.y - 0.6 * text_size, tick.place.x + half, tick.place.y + 0.6 * text_size},
        {255, 255, 255},
        0.8});
    drawing.add(tick);
  }
  for (const PlotSeries& series : plot.series) {
    std::vector<PlotPoint> line;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      const double value = std::isfinite(series.y[i]) ? series.y[i] : plot.range.first;
      line.push_back(around(centre, radius(value), series.x[i]));
    }
    drawing.add(DrawnLine{line, series.stroke});
  }
  drawing.add(DrawnLine{circle(centre, rim), {frame_colour, 0.7}});
}

double legend_height(double width, const std::vector<PlotSeries>& series) {
  return plan_legend(width, series).rows * legend_row * text_size;
}

void draw_legend(Drawing& drawing, PlotPoint top_left, double width, const std::vector<PlotSeries>& series) {
  const LegendPlan plan = plan_legend(width, series);
  std::size_t n = 0;
  for (const PlotSeries& s : series) {
    if (s.label.empty()) continue;
    const PlotPoint& place = plan.place[n++];
    draw_entry(drawing, s, {top_left.x + place.x, top_left.y + place.y}, std::min(plan.column, width - place.x));
  }
}

}  // namespace cloudbow
