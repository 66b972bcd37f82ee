#include "cloudbow/plots/tradeoff_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "cloudbow/core/atomic_file.hpp"
#include "plots/frame.hpp"
#include "plots/line_plot.hpp"

namespace cloudbow {
namespace {

struct ErrorKind {
  const char* name;
  double FluxErrors::*of;
};
constexpr std::array<ErrorKind, 3> kinds{{{"domain mean", &FluxErrors::domain},
                                          {"columns, up at the top", &FluxErrors::up},
                                          {"columns, down at the bottom", &FluxErrors::down}}};

struct Curve {
  std::vector<double> seconds, error;  ///< of each row; the truth's error is NaN
  std::vector<std::size_t> front;
};

Curve curve_of(const TradeoffReport& report, double FluxErrors::*kind) {
  Curve curve;
  for (const TradeoffRow& row : report.rows) {
    curve.seconds.push_back(row.cost.cpu_seconds);
    curve.error.push_back(row.errors ? (*row.errors).*kind : std::numeric_limits<double>::quiet_NaN());
  }
  curve.front = pareto_front(curve.seconds, curve.error);
  return curve;
}

bool on_front(const Curve& curve, std::size_t row) {
  return std::find(curve.front.begin(), curve.front.end(), row) != curve.front.end();
}

std::array<Curve, kinds.size()> curves_of(const TradeoffReport& report) {
  std::array<Curve, kinds.size()> curves;
  std::transform(kinds.begin(), kinds.end(), curves.begin(),
                 [&report](const ErrorKind& kind) { return curve_of(report, kind.of); });
  return curves;
}

constexpr double dot = 1.8, front_dot = 3.2;

std::pair<double, double> error_range(const TradeoffReport& report) {
  std::vector<double> errors;
  for (const TradeoffRow& row : report.rows) {
    for (const ErrorKind& kind : kinds) {
      if (row.errors) errors.push_back((*row.errors).*kind.of);
    }
  }
  return axis_range({.name = "", .unit = "", .logarithmic = true}, errors);
}

/// Names of the levels, each at its largest error.
PlotSeries level_names(const TradeoffReport& report) {
  PlotSeries names;
  names.has_line = false;
  for (const TradeoffRow& row : report.rows) {
    if (!row.errors) continue;
    names.x.push_back(row.cost.cpu_seconds);
    names.y.push_back(std::max({row.errors->domain, row.errors->up, row.errors->down}));
    names.point_label.push_back(row.level);
  }
  return names;
}

}  // namespace

std::string tradeoff_table(const TradeoffReport& report) {
  const auto curves = curves_of(report);
  std::string table = fmt::format("{}: errors against {}, and what each level took\n\n", report.title, report.truth);
  table += fmt::format("{:<20}{:>9}{:>9}{:>10}{:>9}{:>8}{:>12}{:>10}{:>10}\n", "level", "CPU s", "wall s", "tables s",
                       "MB", "sweeps", "domain %", "up %", "down %");
  for (std::size_t n = 0; n < report.rows.size(); ++n) {
    const TradeoffRow& row = report.rows[n];
    table +=
        fmt::format("{:<20}{:>9.2f}{:>9.2f}{:>10.2f}{:>9.0f}{:>8}", row.level, row.cost.cpu_seconds,
                    row.cost.wall_seconds, row.cost.table_seconds, row.cost.peak_memory_bytes * 1e-6, row.cost.sweeps);
    if (row.errors) {
      const auto cell = [&](std::size_t kind) {
        return fmt::format("{:.3f}{}", curves[kind].error[n], on_front(curves[kind], n) ? '*' : ' ');
      };
      table += fmt::format("{:>12}{:>10}{:>10}", cell(0), cell(1), cell(2));
    } else {
      table += fmt::format("{:>11}", "truth");
    }
    table += row.cost.converged ? "\n" : "  NOT CONVERGED\n";
  }
  for (const std::string& note : report.notes) table += note + "\n";
  return table +
         "\ndomain: the larger of |dR| and |dT|, % of incident and emitted; up (at the top), down (direct and diffuse, "
         "at the "
         "bottom): RMS over columns / mean\n"
         "* on the Pareto front: no other level has less of this error in as little CPU time\n";
}

void write_tradeoff_csv(const std::filesystem::path& file, const TradeoffReport& report) {
  const auto curves = curves_of(report);
  std::string text =
      "level,control_points,sweeps,converged,estimated_error,cpu_seconds,wall_seconds,table_seconds,peak_memory_bytes,"
      "domain_error_percent,column_up_error_percent,column_down_error_percent,domain_front,column_up_front,"
      "column_down_front\n";
  for (std::size_t n = 0; n < report.rows.size(); ++n) {
    const auto& [level, cost, errors] = report.rows[n];
    text += fmt::format("{},{},{},{},{},{},{},{},{:.0f}", level, cost.control_points, cost.sweeps,
                        cost.converged ? 1 : 0, cost.estimated_error, cost.cpu_seconds, cost.wall_seconds,
                        cost.table_seconds, cost.peak_memory_bytes);
    for (const Curve& curve : curves) text += errors ? fmt::format(",{}", curve.error[n]) : ",";
    for (const Curve& curve : curves) text += errors ? fmt::format(",{}", on_front(curve, n) ? 1 : 0) : ",";
    text += "\n";
  }
  write_file_atomically(file, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

void write_tradeoff_plot(const std::filesystem::path& file, const TradeoffReport& report) {
  LinePlot plot;
  plot.title = report.title;
  plot.x = {.name = "CPU time of the solve", .unit = "s", .logarithmic = true};
  plot.y = {.name = fmt::format("error against {}", report.truth), .unit = "%", .logarithmic = true};
  plot.y.range = error_range(report);
  std::vector<PlotSeries> legend;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const Curve curve = curve_of(report, kinds[k].of);
    const Stroke stroke{plot_colour(k), 1.2};
    plot.series.push_back({"", curve.seconds, curve.error, stroke, false, dot});
    PlotSeries front{kinds[k].name, {}, {}, stroke, true, front_dot};
    for (const std::size_t n : curve.front) {
      front.x.push_back(curve.seconds[n]);
      front.y.push_back(curve.error[n]);
    }
    plot.series.push_back(front);
    legend.push_back(front);
  }
  for (const TradeoffRow& row : report.rows) {
    if (row.errors) continue;
    const auto [least, largest] = *plot.y.range;
    const double seconds = row.cost.cpu_seconds;
    plot.series.push_back({"truth: " + row.level, {seconds, seconds}, {least, largest}, {{0, 0, 0}, 0.9, {4, 3}}});
    legend.push_back(plot.series.back());
  }
  plot.series.push_back(level_names(report));

  constexpr double plot_height = 290, width = figure_width - 2 * figure_margin;
  Drawing drawing{.width = figure_width, .title = report.title};
  draw(drawing, {figure_margin, figure_margin, figure_width - figure_margin, plot_height}, plot);
  draw_legend(drawing, {4 * figure_margin, plot_height + figure_margin}, width - 4 * figure_margin, legend);
  DrawnText note{
      .markup = "joined, with large dots: the Pareto front (no other level has less error in as little time)",
      .place = {4 * figure_margin, plot_height + 2 * figure_margin + legend_height(width - 4 * figure_margin, legend)},
      .size = 8,
      .hold = TextHold::top,
      .max_width = width - 4 * figure_margin};
  drawing.add(note);
  drawing.height = text_box(note).bottom + figure_margin;
  write_drawing(file, drawing);
}

}  // namespace cloudbow
