#include "cloudbow/plots/phase_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "plots/frame.hpp"
#include "plots/line_plot.hpp"

namespace cloudbow {
namespace {

constexpr double width = 675, row = 280, margin = 10, polar_width = 270;
constexpr double most_decades = 6;  // below the largest value

struct Curves {
  std::vector<PlotSeries> series;  // the function first
  std::pair<double, double> range;
  bool flat = false;  // less than a decade from least to largest
};

Stroke stroke_of(PhaseFitMethod method) {
  const auto index = static_cast<std::size_t>(method);
  switch (method) {
    case PhaseFitMethod::linear_programming:
      return {plot_colour(1), 1.4};
    case PhaseFitMethod::linear_programming_interpolant:
      return {{120, 60, 0}, 0.9, {5, 3}};
    case PhaseFitMethod::linear_programming_bounded:
      return {{160, 0, 60}, 0.9, {2, 2.5}};
    default:
      return {plot_colour(std::array<std::size_t, 5>{5, 0, 2, 3, 4}[index]), 0.9};
  }
}

Curves curves_of(const FittedFunction& fitted, const PhaseReport& report) {
  std::vector<double> angle;
  for (int i = 0; i <= 1440; ++i) angle.push_back(0.25 * i);
  Curves curves;
  PlotSeries truth{"the function itself", angle, {}, {{0, 0, 0}, 1.8}};
  for (const double a : angle) truth.y.push_back(fitted.function(std::cos(a * std::numbers::pi / 180)));
  const auto [least, largest] = std::minmax_element(truth.y.begin(), truth.y.end());
  const double high = std::pow(10, std::ceil(std::log10(1.02 * *largest)));
  const double floor = high * std::pow(10, -most_decades);
  // A decade below the least, so that a fit that falls short is seen to.
  const double low = *least > 0 ? std::pow(10, std::floor(std::log10(*least / 3))) : 1e-3;
  curves.range = {std::max(low, floor), high};
  curves.flat = 10 * *least > *largest;
  curves.series.push_back(std::move(truth));
  for (const PhaseFit& fit : fitted.fits) {
    if (fit.value.size() == 0) continue;
    curves.series.push_back({name_of(fit.method), angle,
                             great_circle_section(report.points, fit.value, report.options.travel, angle),
                             stroke_of(fit.method)});
  }
  return curves;
}

/// Above all curves of a flat function.
double flat_top(const Curves& curves) {
  double top = 0;
  for (const PlotSeries& s : curves.series) top = std::max(top, *std::max_element(s.y.begin(), s.y.end()));
  return axis_range({}, {0, 1.05 * top}).second;
}

}  // namespace

void write_phase_plot(const std::filesystem::path& file, const PhaseReport& report) {
  Drawing drawing{.width = width, .title = report.title};
  double top = margin;
  top += draw_title(drawing, fmt::format("{}; {} control points", report.title, report.points.size()), {width / 2, top},
                    width - 2 * margin, 13) +
         margin;
  std::vector<PlotSeries> legend;
  for (const FittedFunction& fitted : report.functions) {
    const Curves curves = curves_of(fitted, report);
    LinePlot plot;
    plot.title = fitted.name;
    plot.x = {.name = "scattering angle", .unit = "degree", .range = std::pair(0.0, 180.0), .tick_spacing = 30};
    plot.y = {.name = "phase function", .unit = "1", .logarithmic = true, .range = curves.range};
    if (curves.flat) plot.y = {.name = "phase function", .unit = "1", .range = std::pair(0.0, flat_top(curves))};
    plot.series = curves.series;
    draw(drawing, {margin, top, width - polar_width - margin, top + row - margin}, plot);
    draw(drawing, {width - polar_width, top, width - margin, top + row - margin},
         PolarPlot{fitted.name + ", around the direction of travel", curves.range, curves.series});
    legend = curves.series;
    top += row;
  }
  draw_legend(drawing, {4 * margin, top}, width - 5 * margin, legend);
  drawing.height = top + legend_height(width - 5 * margin, legend) + margin;
  write_drawing(file, drawing);
}

}  // namespace cloudbow
