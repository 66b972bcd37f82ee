#include "plots/line_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace cloudbow {
namespace {

constexpr PlotColour frame_colour{60, 60, 60}, grid_colour{222, 222, 222}, minor_grid_colour{240, 240, 240};
constexpr int most_decades_labelled = 8;

bool shown(const PlotAxis& axis, double value) { return std::isfinite(value) && (!axis.logarithmic || value > 0); }

/// Place of a value on the axis, 0 at its least and 1 at its largest.
double fraction(const PlotAxis& axis, std::pair<double, double> range, double value) {
  const auto f = [&axis](double v) { return axis.logarithmic ? std::log10(v) : v; };
  return (f(value) - f(range.first)) / (f(range.second) - f(range.first));
}

double nice_spacing(double length) {
  const double raw = length / 6, power = std::pow(10, std::floor(std::log10(raw)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (raw <= 1.0001 * step * power) return step * power;
  }
  return 10 * power;
}

std::string tick_label(const PlotAxis& axis, double value) {
  if (!axis.logarithmic) return fmt::format("{:.6g}", value == 0 ? 0.0 : value);
  const auto exponent = static_cast<int>(std::lround(std::log10(value)));
  return exponent >= -1 && exponent <= 3 ? fmt::format("{:g}", std::pow(10, exponent))
                                         : fmt::format("10^{{{}}}", exponent);
}

/// Axes with ranges settled and their frame on the canvas.
struct Frame {
  const LinePlot& plot;
  std::pair<double, double> x_range, y_range;
  PlotBox box;

  PlotPoint at(double x, double y) const {
    return {box.left + fraction(plot.x, x_range, x) * box.width(),
            box.bottom - fraction(plot.y, y_range, y) * box.height()};
  }
};

std::pair<double, double> range_over(const LinePlot& plot, const PlotAxis& axis,
                                     std::vector<double> PlotSeries::*values) {
  std::vector<double> all;
  for (const PlotSeries& s : plot.series) all.insert(all.end(), (s.*values).begin(), (s.*values).end());
  return axis_range(axis, all);
}

/// Every n-th power of ten has room for a label.
std::vector<double> labelled(const PlotAxis& axis, std::vector<double> ticks) {
  const std::size_t step = axis.logarithmic ? 1 + ticks.size() / most_decades_labelled : 1;
  std::vector<double> kept;
  for (std::size_t i = (ticks.size() - 1) % step; i < ticks.size(); i += step) kept.push_back(ticks[i]);
  return ticks.empty() ? ticks : kept;
}

double widest_label(const PlotAxis& axis, std::pair<double, double> range, double text_size) {
  double width = 0;
  for (const double tick : labelled(axis, axis_ticks(axis, range)))
    width = std::max(width, PlotCanvas::text_width(tick_label(axis, tick), text_size));
  return width;
}

Frame layout(const PlotBox& box, const LinePlot& plot, double text_size) {
  Frame frame{plot, range_over(plot, plot.x, &PlotSeries::x), range_over(plot, plot.y, &PlotSeries::y), box};
  frame.box.left += widest_label(plot.y, frame.y_range, text_size) + (plot.y.label.empty() ? 1.2 : 3.4) * text_size;
  frame.box.bottom -= (plot.x.label.empty() ? 2.6 : 4.9) * text_size;
  frame.box.top += plot.title.empty() ? text_size : 3 * text_size;
  frame.box.right -= 1.5 * text_size;
  // Lines one pixel wide are sharp if they run through the middle of pixels.
  frame.box = {std::floor(frame.box.left) + 0.5, std::floor(frame.box.top) + 0.5, std::floor(frame.box.right) + 0.5,
               std::floor(frame.box.bottom) + 0.5};
  return frame;
}

void straight(PlotCanvas& canvas, PlotPoint a, PlotPoint b, PlotColour colour) {
  const auto crisp = [](double v) { return std::floor(v) + 0.5; };
  const std::array<PlotPoint, 2> ends{{{crisp(a.x), crisp(a.y)}, {crisp(b.x), crisp(b.y)}}};
  canvas.line(ends, {colour, 1, {}, 1});
}

void draw_grid(PlotCanvas& canvas, const Frame& frame) {
  const auto lines = [&](bool minor, PlotColour colour) {
    for (const double x : axis_ticks(frame.plot.x, frame.x_range, minor)) {
      const double at = frame.at(x, frame.y_range.first).x;
      straight(canvas, {at, frame.box.top}, {at, frame.box.bottom}, colour);
    }
    for (const double y : axis_ticks(frame.plot.y, frame.y_range, minor)) {
      const double at = frame.at(frame.x_range.first, y).y;
      straight(canvas, {frame.box.left, at}, {frame.box.right, at}, colour);
    }
  };
  if (frame.plot.x.logarithmic || frame.plot.y.logarithmic) lines(true, minor_grid_colour);
  lines(false, grid_colour);
}

void draw_axes(PlotCanvas& canvas, const Frame& frame, const PlotBox& outer, double text_size) {
  const auto& [left, top, right, bottom] = frame.box;
  const std::array<PlotPoint, 5> outline{{{left, top}, {right, top}, {right, bottom}, {left, bottom}, {left, top}}};
  canvas.line(outline, {frame_colour, 1, {}, 1});
  for (const double x : labelled(frame.plot.x, axis_ticks(frame.plot.x, frame.x_range))) {
    const double at = frame.at(x, frame.y_range.first).x;
    straight(canvas, {at, bottom}, {at, bottom + 0.5 * text_size}, frame_colour);
    canvas.text(tick_label(frame.plot.x, x), {at, bottom + 1.5 * text_size}, text_size, TextAnchor::centre);
  }
  for (const double y : labelled(frame.plot.y, axis_ticks(frame.plot.y, frame.y_range))) {
    const double at = frame.at(frame.x_range.first, y).y;
    straight(canvas, {left - 0.5 * text_size, at}, {left, at}, frame_colour);
    canvas.text(tick_label(frame.plot.y, y), {left - 0.9 * text_size, at}, text_size, TextAnchor::right);
  }
  canvas.text(frame.plot.x.label, {(left + right) / 2, bottom + 3.7 * text_size}, text_size, TextAnchor::centre);
  canvas.text(frame.plot.y.label, {outer.left + 0.9 * text_size, (top + bottom) / 2}, text_size, TextAnchor::centre,
              TextTurn::upwards);
  canvas.text(frame.plot.title, {(left + right) / 2, top - 1.4 * text_size}, 1.15 * text_size, TextAnchor::centre);
}

/// Above the point to the right, because a falling curve leaves room there; inside the frame.
void draw_point_label(PlotCanvas& canvas, const Frame& frame, PlotPoint at, const std::string& label,
                      double text_size) {
  const double x =
      std::min(at.x + 0.6 * text_size, frame.box.right - PlotCanvas::text_width(label, text_size) - 0.4 * text_size);
  canvas.text(label, {x, std::max(at.y - 1.1 * text_size, frame.box.top + text_size)}, text_size);
}

void draw_series(PlotCanvas& canvas, const Frame& frame, const PlotSeries& series, double text_size) {
  assert(series.x.size() == series.y.size());
  assert(series.point_label.empty() || series.point_label.size() == series.x.size());
  std::vector<PlotPoint> piece;
  const auto finish = [&] {
    if (series.has_line) canvas.line(piece, series.stroke, frame.box);
    for (const PlotPoint& p : piece) {
      if (series.marker_radius > 0) canvas.disc(p, series.marker_radius, series.stroke.colour, frame.box);
    }
    piece.clear();
  };
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (shown(frame.plot.x, series.x[i]) && shown(frame.plot.y, series.y[i])) {
      piece.push_back(frame.at(series.x[i], series.y[i]));
      if (!series.point_label.empty()) draw_point_label(canvas, frame, piece.back(), series.point_label[i], text_size);
    } else {
      finish();
    }
  }
  finish();
}

constexpr double legend_line_length = 3.5;  // length of a line in the legend, in text sizes
constexpr double row_height = 2.0;          // of the legend, in text sizes

double entry_width(const PlotSeries& series, double text_size) {
  return (legend_line_length + 1) * text_size + PlotCanvas::text_width(series.label, text_size);
}

void draw_entry(PlotCanvas& canvas, const PlotSeries& series, PlotPoint at, double text_size) {
  const std::array<PlotPoint, 2> sample{{at, {at.x + legend_line_length * text_size, at.y}}};
  if (series.has_line) canvas.line(sample, series.stroke);
  if (series.marker_radius > 0)
    canvas.disc({at.x + legend_line_length / 2 * text_size, at.y}, series.marker_radius, series.stroke.colour,
                canvas.everything());
  canvas.text(series.label, {at.x + (legend_line_length + 1) * text_size, at.y}, text_size);
}

void draw_legend_inside(PlotCanvas& canvas, const Frame& frame, double text_size) {
  double width = 0;
  int rows = 0;
  for (const PlotSeries& s : frame.plot.series) {
    if (s.label.empty()) continue;
    width = std::max(width, entry_width(s, text_size));
    ++rows;
  }
  if (frame.plot.legend == LegendPlace::none || rows == 0) return;
  const bool at_left = frame.plot.legend == LegendPlace::top_left || frame.plot.legend == LegendPlace::bottom_left;
  const bool at_top = frame.plot.legend == LegendPlace::top_left || frame.plot.legend == LegendPlace::top_right;
  const double margin = text_size, height = rows * row_height * text_size;
  const double left = at_left ? frame.box.left + 2 * margin : frame.box.right - 2 * margin - width;
  const double top = at_top ? frame.box.top + 1.5 * margin : frame.box.bottom - 1.5 * margin - height;
  canvas.fill({left - margin, top - 0.5 * margin, left + width + margin, top + height + 0.5 * margin}, {255, 255, 255},
              0.85);
  double y = top + row_height / 2 * text_size;
  for (const PlotSeries& s : frame.plot.series) {
    if (s.label.empty()) continue;
    draw_entry(canvas, s, {left, y}, text_size);
    y += row_height * text_size;
  }
}

std::vector<PlotPoint> circle(PlotPoint centre, double radius) {
  constexpr int steps = 180;
  std::vector<PlotPoint> points;
  for (int i = 0; i <= steps; ++i) {
    const double angle = 2 * std::numbers::pi * i / steps;
    points.push_back({centre.x + radius * std::cos(angle), centre.y - radius * std::sin(angle)});
  }
  return points;
}

PlotPoint around(PlotPoint centre, double radius, double angle_deg) {
  const double angle = angle_deg * std::numbers::pi / 180;
  return {centre.x + radius * std::cos(angle), centre.y - radius * std::sin(angle)};
}

}  // namespace

std::vector<double> axis_ticks(const PlotAxis& axis, std::pair<double, double> range, bool minor) {
  const auto& [least, largest] = range;
  std::vector<double> ticks;
  if (axis.logarithmic) {
    constexpr double rounding = 1 + 1e-9;
    for (int n = static_cast<int>(std::floor(std::log10(least))); std::pow(10, n) <= largest * rounding; ++n) {
      for (int digit = minor ? 2 : 1; digit <= (minor ? 9 : 1); ++digit) {
        const double tick = digit * std::pow(10, n);
        if (tick >= least / rounding && tick <= largest * rounding) ticks.push_back(tick);
      }
    }
    return ticks;
  }
  if (minor) return ticks;
  const double spacing = axis.tick_spacing.value_or(nice_spacing(largest - least));
  for (double n = std::ceil(least / spacing - 1e-6); n * spacing <= largest + 1e-6 * spacing; ++n)
    ticks.push_back(n * spacing);
  return ticks;
}

std::pair<double, double> axis_range(const PlotAxis& axis, const std::vector<double>& values) {
  if (axis.range) return *axis.range;
  double least = std::numeric_limits<double>::infinity(), largest = -least;
  for (const double v : values) {
    if (!shown(axis, v)) continue;
    least = std::min(least, v);
    largest = std::max(largest, v);
  }
  if (least > largest) return axis.logarithmic ? std::pair(1.0, 10.0) : std::pair(0.0, 1.0);
  if (axis.logarithmic) {
    const double low = std::pow(10, std::floor(std::log10(least) + 1e-9));
    const double high = std::pow(10, std::ceil(std::log10(largest) - 1e-9));
    return {low, high > low ? high : 10 * low};
  }
  if (least == largest) return {least - 0.5, largest + 0.5};
  const double spacing = axis.tick_spacing.value_or(nice_spacing(largest - least));
  return {spacing * std::floor(least / spacing + 1e-6), spacing * std::ceil(largest / spacing - 1e-6)};
}

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

void draw(PlotCanvas& canvas, const PlotBox& box, const LinePlot& plot, double text_size) {
  const Frame frame = layout(box, plot, text_size);
  draw_grid(canvas, frame);
  for (const PlotSeries& series : plot.series) draw_series(canvas, frame, series, text_size);
  draw_axes(canvas, frame, box, text_size);
  draw_legend_inside(canvas, frame, text_size);
}

void draw(PlotCanvas& canvas, const PlotBox& box, const PolarPlot& plot, double text_size) {
  const PlotAxis axis{"", true, plot.range, {}};
  const double title_height = plot.title.empty() ? 0 : 3 * text_size, label = 4 * text_size;
  const PlotPoint centre{(box.left + box.right) / 2, (box.top + title_height + box.bottom) / 2};
  const double rim = std::min(box.width() / 2 - label, (box.height() - title_height) / 2 - 0.7 * label);

  const auto radius = [&](double value) {
    return rim * fraction(axis, plot.range, std::clamp(value, plot.range.first, plot.range.second));
  };
  const std::vector<double> ticks = axis_ticks(axis, plot.range);
  for (const double tick : ticks) canvas.line(circle(centre, radius(tick)), {grid_colour, 1, {}, 1});
  for (int angle = 0; angle < 360; angle += 30) {
    const std::array<PlotPoint, 2> spoke{centre, around(centre, rim, angle)};
    canvas.line(spoke, {grid_colour, 1, {}, 1});
    canvas.text(fmt::format("{}\u00b0", angle), around(centre, rim + 2.2 * text_size, angle), text_size,
                TextAnchor::centre);
  }
  // Below the curves, which they must not hide.
  for (const double tick : labelled(axis, ticks)) {
    if (radius(tick) < 0.1 * rim || radius(tick) > 0.95 * rim) continue;
    const std::string text = tick_label(axis, tick);
    const PlotPoint place = around(centre, radius(tick), 105);
    const double half = PlotCanvas::text_width(text, text_size) / 2 + 0.3 * text_size;
    canvas.fill({place.x - half, place.y - 0.9 * text_size, place.x + half, place.y + 0.9 * text_size}, {255, 255, 255},
                0.8);
    canvas.text(text, place, text_size, TextAnchor::centre);
  }
  for (const PlotSeries& series : plot.series) {
    std::vector<PlotPoint> line;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      const double value = std::isfinite(series.y[i]) ? series.y[i] : plot.range.first;
      line.push_back(around(centre, radius(value), series.x[i]));
    }
    canvas.line(line, series.stroke);
  }
  canvas.line(circle(centre, rim), {frame_colour, 1, {}, 1});
  canvas.text(plot.title, {centre.x, box.top + 1.6 * text_size}, 1.15 * text_size, TextAnchor::centre);
}

double draw_legend(PlotCanvas& canvas, const PlotBox& box, const std::vector<PlotSeries>& series, double text_size) {
  double column = 0;
  for (const PlotSeries& s : series) column = std::max(column, entry_width(s, text_size) + 3 * text_size);
  const int columns = std::max(1, static_cast<int>(box.width() / column));
  int count = 0;
  for (const PlotSeries& s : series) {
    if (s.label.empty()) continue;
    draw_entry(canvas, s,
               {box.left + (count % columns) * column, box.top + (count / columns + 0.5) * row_height * text_size},
               text_size);
    ++count;
  }
  return (count + columns - 1) / columns * row_height * text_size;
}

}  // namespace cloudbow
