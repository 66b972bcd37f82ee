// Plots of curves: linear or logarithmic axes, polar diagrams, legends.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plots/plot_canvas.hpp"

namespace cloudbow {

struct PlotSeries {
  std::string label;  ///< empty: not in the legend
  std::vector<double> x, y;
  Stroke stroke;
  bool has_line = true;
  double marker_radius = 0;                ///< 0: no markers
  std::vector<std::string> point_label{};  ///< above each point to the right; empty: none
};

struct PlotAxis {
  std::string label;
  bool logarithmic = false;
  std::optional<std::pair<double, double>> range;  ///< default: of the data, widened to ticks
  std::optional<double> tick_spacing;              ///< linear axes; default: about six ticks, at 1, 2 or 5 times 10^n
};

enum class LegendPlace { none, top_left, top_right, bottom_left, bottom_right };

struct LinePlot {
  std::string title;
  PlotAxis x, y;
  std::vector<PlotSeries> series;  ///< not finite, or <= 0 on a logarithmic axis: the line is broken there
  LegendPlace legend = LegendPlace::top_right;
};

/// Curves around a point: 0 degrees to the right, counter-clockwise; the radius is the logarithm of the value.
struct PolarPlot {
  std::string title;
  std::pair<double, double> range;  ///< values at the centre (below counts as that) and at the rim, both > 0
  std::vector<PlotSeries> series;   ///< x: angle [deg], y: value
};

/// @param text_size height of a capital letter of the labels [pixels]
void draw(PlotCanvas& canvas, const PlotBox& box, const LinePlot& plot, double text_size);
void draw(PlotCanvas& canvas, const PlotBox& box, const PolarPlot& plot, double text_size);

/// Entries side by side, in as many rows as the width needs; from the top of the box. @returns the height used.
double draw_legend(PlotCanvas& canvas, const PlotBox& box, const std::vector<PlotSeries>& series, double text_size);

/// Values at the ticks of an axis, least to largest, inside the range. Logarithmic: powers of ten, or with `minor`
/// their multiples 2 to 9.
std::vector<double> axis_ticks(const PlotAxis& axis, std::pair<double, double> range, bool minor = false);
/// The range of an axis that shows these values.
std::pair<double, double> axis_range(const PlotAxis& axis, const std::vector<double>& values);

/// Eight colours that can be distinguished with any colour vision (Okabe & Ito 2008), in turn.
PlotColour plot_colour(std::size_t index);

}  // namespace cloudbow
