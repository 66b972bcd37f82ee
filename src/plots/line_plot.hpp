// Plots of curves: linear or logarithmic axes, polar diagrams, legends.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "plots/axis.hpp"
#include "plots/drawing.hpp"

namespace cloudbow {

struct PlotSeries {
  std::string label;  ///< plain text; empty: not in the legend
  std::vector<double> x, y;
  Stroke stroke;
  bool has_line = true;
  double marker_radius = 0;                ///< 0: no markers
  std::vector<std::string> point_label{};  ///< above each point to the right; empty: none
};

struct LinePlot {
  std::string title;
  PlotAxis x, y;
  std::vector<PlotSeries> series;  ///< not finite, or <= 0 on a logarithmic axis: the line is broken there
};

/// Curves around a point: 0 degrees to the right, counter-clockwise; the radius is the logarithm of the value.
struct PolarPlot {
  std::string title;
  std::pair<double, double> range;  ///< values at the centre (below counts as that) and at the rim, both > 0
  std::vector<PlotSeries> series;   ///< x: angle [deg], y: value
};

/// Both fill the box with title, axes and curves.
void draw(Drawing& drawing, const PlotBox& box, const LinePlot& plot);
void draw(Drawing& drawing, const PlotBox& box, const PolarPlot& plot);

/// Entries side by side, in as many rows as the width needs; from the top of the box.
void draw_legend(Drawing& drawing, PlotPoint top_left, double width, const std::vector<PlotSeries>& series);
/// The height that they use.
double legend_height(double width, const std::vector<PlotSeries>& series);

/// Eight colours that can be distinguished with any colour vision (Okabe & Ito 2008), in turn.
PlotColour plot_colour(std::size_t index);

}  // namespace cloudbow
