#include "cloudbow/plots/column_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plots/colormap.hpp"
#include "plots/line_plot.hpp"
#include "plots/plot_canvas.hpp"

namespace cloudbow {
namespace {

constexpr double text_size = 11;
constexpr double margin = 70;
constexpr double longer_side = 640;
constexpr double flattest = 4;  // a map is stretched if it would be flatter or steeper than this
constexpr int colour_count = 200;

void draw_curve(const std::filesystem::path& file, const ColumnPlot& plot) {
  const int axis = plot.columns[0] == 1 ? 1 : 0;
  LinePlot curve;
  curve.title = plot.title;
  curve.x.label = fmt::format("{} [m]", "xy"[axis]);
  curve.y.label = plot.label;
  curve.legend = LegendPlace::none;
  PlotSeries series;
  series.stroke.colour = plot_colour(0);
  for (int n = 0; n < plot.columns[axis]; ++n) {
    for (const int side : {0, 1}) {
      series.x.push_back(plot.min_m[axis] + (n + side) * plot.column_size_m[axis]);
      series.y.push_back(plot.value[static_cast<std::size_t>(n)]);
    }
  }
  curve.series.push_back(std::move(series));
  PlotCanvas canvas(900, 420);
  draw(canvas, {margin, 40, 880, 360}, curve, text_size);
  canvas.write_png(file);
}

// Adding 0 to a tick makes "0" of -0.
void draw_ticks(PlotCanvas& canvas, const PlotBox& box, const ColumnPlot& plot, int axis) {
  const double low = plot.min_m[axis], high = low + plot.columns[axis] * plot.column_size_m[axis];
  for (const double tick : axis_ticks(PlotAxis{}, {low, high})) {
    const double share = (tick - low) / (high - low);
    if (axis == 0) {
      canvas.text(fmt::format("{:g}", tick + 0.0), {box.left + share * box.width(), box.bottom + 14}, text_size,
                  TextAnchor::centre);
    } else {
      canvas.text(fmt::format("{:g}", tick + 0.0), {box.left - 6, box.bottom - share * box.height()}, text_size,
                  TextAnchor::right);
    }
  }
}

void draw_map(const std::filesystem::path& file, const ColumnPlot& plot) {
  const double aspect = std::clamp(plot.columns[1] * plot.column_size_m[1] / (plot.columns[0] * plot.column_size_m[0]),
                                   1 / flattest, flattest);
  const double width = std::round(longer_side / std::max(1.0, aspect)), height = std::round(width * aspect);
  PlotCanvas canvas(static_cast<int>(width + 2 * margin + 90), static_cast<int>(height + 2 * margin));
  const PlotBox box{margin, margin, margin + width, margin + height};
  const std::vector<Rgb> colour = make_colormap("blue-yellow", colour_count);
  const double largest = *std::max_element(plot.value.begin(), plot.value.end());
  const auto colour_of = [&](double share) {
    return colour[static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * (colour_count - 1))];
  };
  for (int py = 0; py < static_cast<int>(height); ++py) {
    const auto j = static_cast<std::size_t>((height - py - 0.5) / height * plot.columns[1]);
    for (int px = 0; px < static_cast<int>(width); ++px) {
      const auto i = static_cast<std::size_t>((px + 0.5) / width * plot.columns[0]);
      const double value = plot.value[j * static_cast<std::size_t>(plot.columns[0]) + i];
      const double x = box.left + px, y = box.top + py;
      canvas.fill({x, y, x + 1, y + 1}, colour_of(largest > 0 ? value / largest : 0));
    }
  }
  const PlotBox scale{box.right + 20, box.top, box.right + 40, box.bottom};
  for (int py = 0; py < static_cast<int>(height); ++py) {
    canvas.fill({scale.left, scale.top + py, scale.right, scale.top + py + 1}, colour_of(1 - (py + 0.5) / height));
  }
  for (const double tick : axis_ticks(PlotAxis{}, {0, largest})) {
    canvas.text(fmt::format("{:.4g}", tick + 0.0), {scale.right + 6, scale.bottom - tick / largest * scale.height()},
                text_size);
  }
  draw_ticks(canvas, box, plot, 0);
  draw_ticks(canvas, box, plot, 1);
  canvas.text(fmt::format("{}: {}", plot.title, plot.label), {box.left, box.top - 24}, text_size);
  canvas.text("x [m]", {box.left + 0.5 * width, box.bottom + 36}, text_size, TextAnchor::centre);
  canvas.text("y [m]", {16, box.top + 0.5 * height}, text_size, TextAnchor::centre, TextTurn::upwards);
  canvas.write_png(file);
}

}  // namespace

void write_column_plot(const std::filesystem::path& file, const ColumnPlot& plot) {
  if (plot.columns[0] == 1 || plot.columns[1] == 1) {
    draw_curve(file, plot);
  } else {
    draw_map(file, plot);
  }
}

}  // namespace cloudbow
