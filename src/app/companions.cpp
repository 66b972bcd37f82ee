#include "companions.hpp"

#include <algorithm>

namespace cloudbow {
namespace {

// A companion's own iteration and its last gather need only be good beside its few directions.
constexpr double kTolerance = 1e-2;
constexpr double kEnergyTolerance = 1e-3;

}  // namespace

SolverOptions companion_options(const SolverOptions& options, bool one_column) {
  SolverOptions fewer = options;
  fewer.control_points = 42;
  fewer.directions = "double-gauss-4x8";
  fewer.fit.delta_m_order = 4;
  fewer.fit.beam_delta_m_order = 6;
  fewer.fit.exact_moments = 2;
  fewer.fit.beam_half_range_rows = 2;
  fewer.fit.minimax = true;
  fewer.gather_directions = std::min(options.gather_directions, 32);
  fewer.beam_rays = 1;
  fewer.tolerance = one_column ? options.tolerance : std::max(options.tolerance, kTolerance);
  fewer.energy_tolerance = one_column ? options.energy_tolerance : kEnergyTolerance;
  fewer.absorption = fewer.actinic = fewer.radiance_field = false;
  fewer.views.clear();
  fewer.cameras.clear();
  fewer.flux_levels = FluxLevels::boundaries;
  if (options.flux_levels == FluxLevels::listed) {
    fewer.flux_levels = FluxLevels::listed;
    fewer.listed_levels = {options.listed_levels.front(), options.listed_levels.back()};
    fewer.listed_levels.erase(std::unique(fewer.listed_levels.begin(), fewer.listed_levels.end()),
                              fewer.listed_levels.end());
  }
  return fewer;
}

Companions solve_companions(const Problem& problem, const SolverOptions& options, bool one_column,
                            const ProgressCallback& progress) {
  SolverOptions fewer = companion_options(options, one_column);
  Companions companions;
  companions.linear = solve(problem, fewer, progress);
  fewer.linear_source = false;
  companions.constant = solve(problem, fewer, progress);
  return companions;
}

double predict_companion_seconds(const Problem& problem, const SolverOptions& options, bool one_column) {
  return 2 * predict_seconds(problem, companion_options(options, one_column));
}

}  // namespace cloudbow
