#include "companions.hpp"

#include <algorithm>

#include "cloudbow/transport/columns.hpp"

namespace cloudbow {
namespace {

// A companion's own iteration and its last gather need only be good beside its few directions.
constexpr double kTolerance = 1e-2;
constexpr double kEnergyTolerance = 1e-3;

constexpr int kFewStreams = 4;

struct Directions {
  int control_points;
  const char* ordinates;
  int delta_m_order;
  int exact_moments;
  int beam_half_range_rows;
};

// Of fields: as few as still tell where more would matter.
constexpr Directions kField{42, "double-gauss-4x8", 4, 2, 2};
// A single column costs next to nothing, and its errors are so small that few directions say little of them: against a
// better solution at the draft, else against one that is nearly as good, on the same control points.
constexpr Directions kColumnOfDraft{162, "reduced-double-gauss-12x20", 12, 3, 3};
constexpr Directions kColumnOfBalanced{162, "reduced-double-gauss-10x16", 10, 3, 3};
constexpr Directions kColumn{642, "double-gauss-14x20", 12, 3, 3};

void set_directions(const Directions& directions, SolverOptions& options) {
  options.control_points = directions.control_points;
  options.directions = directions.ordinates;
  options.fit.delta_m_order = directions.delta_m_order;
  options.fit.exact_moments = directions.exact_moments;
  options.fit.beam_half_range_rows = directions.beam_half_range_rows;
  options.fit.minimax = true;
}

}  // namespace

SolverOptions companion_options(const SolverOptions& options, const std::string& accuracy, bool one_column) {
  SolverOptions other = options;
  const int beyond = options.fit.beam_delta_m_order - options.fit.delta_m_order;
  if (one_column) {
    set_directions(accuracy == "draft" ? kColumnOfDraft : accuracy == "balanced" ? kColumnOfBalanced : kColumn, other);
  } else {
    set_directions(kField, other);
    other.gather_directions = std::min(options.gather_directions, 32);
    other.beam_rays = 1;
    other.tolerance = std::max(options.tolerance, kTolerance);
    other.energy_tolerance = kEnergyTolerance;
  }
  other.column_streams = options.column_streams > kFewStreams ? kFewStreams : 2 * kFewStreams;
  other.fit.beam_delta_m_order = other.fit.delta_m_order + beyond;
  other.absorption = other.actinic = other.radiance_field = false;
  other.views.clear();
  other.cameras.clear();
  other.flux_levels = FluxLevels::boundaries;
  if (options.flux_levels == FluxLevels::listed) {
    other.flux_levels = FluxLevels::listed;
    other.listed_levels = {options.listed_levels.front()};
    if (options.listed_levels.size() > 1) other.listed_levels.push_back(options.listed_levels.back());
  }
  return other;
}

Companions solve_companions(const Problem& problem, const SolverOptions& options, const std::string& accuracy,
                            bool one_column, const ProgressCallback& progress) {
  SolverOptions other = companion_options(options, accuracy, one_column);
  Companions companions;
  companions.linear = solve(problem, other, progress);
  if (solved_without_azimuths(problem, other)) {  // exact in the vertical
    companions.constant = companions.linear;
    companions.constant.report = {};  // one solve
    return companions;
  }
  other.linear_source = false;
  companions.constant = solve(problem, other, progress);
  return companions;
}

double predict_companion_seconds(const Problem& problem, const SolverOptions& options, const std::string& accuracy,
                                 bool one_column) {
  const SolverOptions other = companion_options(options, accuracy, one_column);
  return (solved_without_azimuths(problem, other) ? 1 : 2) * predict_seconds(problem, other);
}

}  // namespace cloudbow
