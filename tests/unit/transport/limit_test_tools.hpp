// A small cloudy problem under suns of any height.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>

#include "cloudbow/transport/solver.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {

inline Problem cloudy(bool periodic = true) {
  const BoxGrid box = make_box(4, 3, 3, periodic);
  Problem problem;
  problem.grid = make_grid(box, random_extinction(box, 2., 1), .99);
  problem.phase = {PhaseFunction::henyey_greenstein(.85)};
  problem.sun = Sun{travel_along(-.6, 37), 1.};
  problem.sky_radiance = .125;
  problem.surface.albedo = .25;
  return problem;
}

inline SolverOptions quick() {
  SolverOptions options = coarse_options();
  options.actinic = true;
  options.tolerance = 1e-3;
  return options;
}

inline std::size_t predicted_memory(const Problem& problem, const SolverOptions& options) {
  return predict_memory(SolvePlan(problem, options));
}

inline double predicted_seconds(const Problem& problem, const SolverOptions& options) {
  return predict_seconds(SolvePlan(problem, options));
}

inline Problem under_zenith(double zenith_deg, bool periodic = true) {
  Problem problem = cloudy(periodic);
  problem.sun->travel = travel_along(-std::cos(zenith_deg * std::numbers::pi / 180), 0);
  return problem;
}

}  // namespace cloudbow
