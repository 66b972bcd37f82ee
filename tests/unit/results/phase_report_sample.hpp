// A small report on a phase function.
#pragma once

#include <utility>
#include <vector>

#include "cloudbow/optics/delta_m.hpp"
#include "cloudbow/results/phase_report.hpp"

namespace cloudbow {

inline PhaseReport sample_report(double g = 0.5) {
  const ControlPoints points(42);
  const auto phase = PhaseFunction::henyey_greenstein(g);
  const DeltaM scaled = delta_m(phase, 6);
  const OrdinateSet ordinates = make_ordinate_set("double-gauss-6x8");
  const std::vector<PhaseFitMethod> methods = {PhaseFitMethod::least_squares, PhaseFitMethod::linear_programming};
  PhaseReport report{"sample", 6, scaled.forward_fraction, points, ordinates.name, {}, {}};
  for (const auto& [name, function] : {std::pair("raw", phase), std::pair("delta-M", scaled.truncated)}) {
    report.functions.push_back({name, function, fit_phase_function(function, points, ordinates, methods, {})});
  }
  return report;
}

}  // namespace cloudbow
