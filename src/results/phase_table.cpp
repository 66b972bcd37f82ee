#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cloudbow/results/phase_report.hpp"

namespace cloudbow {
namespace {

constexpr int moments_shown = 10;

struct Range {
  double least, largest;
};

Range range_of(const PhaseFunction& phase) {
  constexpr int steps = 3600;
  Range range{phase(1), phase(1)};
  for (int i = 1; i <= steps; ++i) {
    const double value = phase(std::cos(std::numbers::pi * i / steps));
    range = {std::min(range.least, value), std::max(range.largest, value)};
  }
  return range;
}

std::string function_lines(const FittedFunction& fitted) {
  const auto [least, largest] = range_of(fitted.function);
  std::string text = fmt::format("\n{}: asymmetry {:.6g}, values {:.4g} to {:.5g}\n", fitted.name,
                                 fitted.function.asymmetry_parameter(), least, largest);
  text += "  l      ";
  for (int l = 0; l < moments_shown; ++l) text += fmt::format("{:9}", l);
  text += "\n  chi_l  ";
  for (int l = 0; l < moments_shown; ++l) text += fmt::format("{:9.5f}", fitted.function.moment(l));
  return text + "\n";
}

/// A difference from the exact value: rounding is shown as such.
std::string deviation(double value) {
  return std::abs(value) < 1e-4 ? fmt::format("{:.1e}", value) : fmt::format("{:.5f}", value);
}

std::string fit_line(const PhaseFit& fit, double asymmetry) {
  const std::string name = name_of(fit.method);
  if (fit.value.size() == 0) return fmt::format("  {:30}  no solution found\n", name);
  const PhaseFitErrors& e = fit.errors;
  return fmt::format("  {:30} {:9.4g} {:7.1f} {:9.4g} {:9.4g} {:9.4g} {:>9} {:>9} {:>9} {:>9} {:9.3g} {:6.2f}\n", name,
                     e.max_error, e.worst_angle_deg, e.max_error_between, e.rms_error, e.scaled_error,
                     deviation(e.ordinate_norm - 1), deviation(e.ordinate_asymmetry - asymmetry),
                     deviation(e.interpolant_norm - 1), deviation(e.interpolant_asymmetry - asymmetry), e.least_value,
                     fit.seconds);
}

/// Message if fewer moments could be preserved than were requested.
std::string shortfall(const FittedFunction& fitted, int asked) {
  std::string text;
  for (const PhaseFit& fit : fitted.fits) {
    if (fit.exact_degree < 0 || fit.exact_degree >= asked) continue;
    text += fmt::format(
        "  {}: moments l <= {} are infeasible (no solution as positive as the function holds them); held are l <= {}\n",
        name_of(fit.method), asked, fit.exact_degree);
  }
  return text;
}

}  // namespace

std::string phase_table(const PhaseReport& report) {
  std::string text = fmt::format("{}\n", report.title);
  text += report.forward_fraction > 0
              ? fmt::format("delta-M of order {}: f = {:.6g}\n", report.delta_m_order, report.forward_fraction)
              : fmt::format("delta-M of order {}: no forward peak, f = 0, the function stays as it is\n",
                            report.delta_m_order);
  const Direction travel = report.options.travel.normalized();
  text += fmt::format("{} control points, quadrature {}, light travelling along ({:.3g}, {:.3g}, {:.3g})\n",
                      report.points.size(), report.ordinates, travel.x(), travel.y(), travel.z());
  for (const FittedFunction& fitted : report.functions) {
    text += function_lines(fitted);
    if (fitted.fits.empty()) continue;
    text += fmt::format("  {:30} {:>9} {:>7} {:>9} {:>9} {:>9} {:^19} {:^19} {:>9} {:>6}\n", "", "max", "at", "max",
                        "RMS", "max err", "quadrature", "interpolant", "least", "");
    text +=
        fmt::format("  {:30} {:>9} {:>7} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>6}\n", "fit", "error",
                    "deg", "between", "error", "/sqrt P", "norm - 1", "g error", "norm - 1", "g error", "value", "s");
    for (const PhaseFit& fit : fitted.fits) text += fit_line(fit, fitted.function.asymmetry_parameter());
    text += shortfall(fitted, report.options.exact_moments);
  }
  return text;
}

}  // namespace cloudbow
