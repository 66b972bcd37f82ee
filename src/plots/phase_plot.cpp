#include "cloudbow/plots/phase_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "plots/line_plot.hpp"

namespace cloudbow {
namespace {

constexpr int width = 1500, row = 620;
constexpr double text_size = 11, margin = 18, polar_width = 600;
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
      return {plot_colour(1), 2.6, {}, 1};
    case PhaseFitMethod::linear_programming_interpolant:
      return {{120, 60, 0}, 1.8, {9, 6}, 1};
    case PhaseFitMethod::linear_programming_bounded:
      return {{160, 0, 60}, 1.8, {3, 4.5}, 1};
    default:
      return {plot_colour(std::array<std::size_t, 5>{5, 0, 2, 3, 4}[index]), 1.6, {}, 1};
  }
}

Curves curves_of(const FittedFunction& fitted, const PhaseReport& report) {
  std::vector<double> angle;
  for (int i = 0; i <= 1440; ++i) angle.push_back(0.25 * i);
  Curves curves;
  PlotSeries truth{"the function itself", angle, {}, {{0, 0, 0}, 3.4, {}, 1}};
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
  const auto rows = static_cast<int>(report.functions.size());
  constexpr double title_height = 3.5 * text_size, legend_height = 7 * text_size;
  PlotCanvas canvas(width, static_cast<int>(title_height + rows * row + legend_height + margin));
  canvas.text(fmt::format("{}; {} control points", report.title, report.points.size()), {width / 2.0, 2.2 * text_size},
              1.4 * text_size, TextAnchor::centre);
  double top = title_height;
  std::vector<PlotSeries> legend;
  for (const FittedFunction& fitted : report.functions) {
    const Curves curves = curves_of(fitted, report);
    LinePlot plot;
    plot.title = fitted.name;
    plot.x = {"scattering angle [degree]", false, std::pair(0.0, 180.0), 30};
    plot.y = {"phase function", true, curves.range, {}};
    if (curves.flat) plot.y = {"phase function", false, std::pair(0.0, flat_top(curves)), {}};
    plot.series = curves.series;
    plot.legend = LegendPlace::none;
    draw(canvas, {margin, top, width - polar_width - margin, top + row}, plot, text_size);
    draw(canvas, {width - polar_width, top, width - margin, top + row},
         PolarPlot{fitted.name + ", around the direction of travel", curves.range, curves.series}, text_size);
    legend = curves.series;
    top += row;
  }
  draw_legend(canvas, {6 * text_size, top + margin / 2, width - margin, top + legend_height}, legend, text_size);
  canvas.write_png(file);
}

}  // namespace cloudbow
