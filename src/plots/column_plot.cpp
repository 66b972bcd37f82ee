#include "cloudbow/plots/column_plot.hpp"

#include <algorithm>

#include "plots/field_figure.hpp"
#include "plots/frame.hpp"
#include "plots/line_plot.hpp"

namespace cloudbow {
namespace {

/// Steps: a value for each column.
Drawing curve_figure(const ColumnPlot& plot) {
  const std::size_t axis = plot.columns[0] == 1 ? 1 : 0;
  const double start = plot.min_m[axis], width = plot.column_size_m[axis];
  const bool long_axis = plot.columns[axis] * width >= 2000;
  const double metres = long_axis ? 1000 : 1;
  LinePlot curve;
  curve.title = plot.title;
  curve.x = {.name = axis == 0 ? "x" : "y", .unit = long_axis ? "km" : "m"};
  curve.x.range = std::pair(start / metres, (start + plot.columns[axis] * width) / metres);
  curve.y = {.name = plot.name, .unit = plot.unit};
  PlotSeries series{"", {}, {}, {plot_colour(0), 1.2}};
  for (int n = 0; n < plot.columns[axis]; ++n) {
    for (const int side : {0, 1}) {
      series.x.push_back((start + (n + side) * width) / metres);
      series.y.push_back(plot.value[static_cast<std::size_t>(n)]);
    }
  }
  curve.series.push_back(std::move(series));
  Drawing drawing{.width = figure_width, .height = 240, .title = plot.title};
  draw(drawing, {figure_margin, figure_margin, figure_width - figure_margin, drawing.height - figure_margin}, curve);
  return drawing;
}

Drawing column_map(const ColumnPlot& plot) {
  FluxImage image;
  image.variable = plot.name;
  image.units = plot.unit;
  image.columns = plot.columns[0];
  image.rows = plot.columns[1];
  image.column_start_m = plot.min_m[0];
  image.column_width_m = plot.column_size_m[0];
  for (int row = 0; row <= image.rows; ++row) image.row_edge_m.push_back(plot.min_m[1] + row * plot.column_size_m[1]);
  image.value.assign(plot.value.begin(), plot.value.end());
  const double largest = *std::max_element(plot.value.begin(), plot.value.end());
  return field_figure(image, colour_scale(plot.name, plot.unit, {0, largest}, {}), plot.title);
}

}  // namespace

void write_column_plot(const std::filesystem::path& file, const ColumnPlot& plot) {
  const bool curve = plot.columns[0] == 1 || plot.columns[1] == 1;
  write_drawing(file, curve ? curve_figure(plot) : column_map(plot));
}

}  // namespace cloudbow
