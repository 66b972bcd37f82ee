#include "app/planning/coarse_solves.hpp"

#include <algorithm>
#include <vector>

#include "cloudbow/transport/output_fields.hpp"
#include "cloudbow/transport/probe_columns.hpp"
#include "cloudbow/transport/solve_seconds.hpp"
#include "cloudbow/transport/solver.hpp"

namespace cloudbow {
namespace {

// The iteration and the final gather of a coarse solve need only be good compared with its few directions.
constexpr double coarse_tolerance = 1.5e-2;
constexpr double coarse_energy_tolerance = 3e-3;

// Columns without azimuths. A field of them takes the fewest streams that still show the error, to save time. One
// column takes more streams than it has; their distance is then its error.
constexpr int few_streams = 4;
constexpr int most_streams = 16;
int streams_of_field(int streams) { return streams > few_streams ? few_streams : 2 * few_streams; }
int streams_of_column(int streams) { return streams < most_streams ? std::min(2 * streams, most_streams) : 12; }

struct Directions {
  int control_points;
  const char* ordinates;
  int delta_m_order;
  int exact_moments;
  int beam_half_range_rows;
};

// For fields: as few as still show if more would matter.
constexpr Directions field_directions{42, "double-gauss-4x8", 4, 2, 2};
// A single column costs next to nothing, and its errors are so small that few directions do not show them. The draft is
// compared with a better solution. Other levels are compared with one that is nearly as good, on the same control
// points.
constexpr Directions column_directions_of_draft{162, "reduced-double-gauss-12x20", 12, 3, 3};
constexpr Directions column_directions_of_balanced{162, "reduced-double-gauss-10x16", 10, 3, 3};
constexpr Directions column_directions{642, "double-gauss-14x20", 12, 3, 3};

void set_directions(const Directions& directions, SolverOptions& options) {
  options.control_points = directions.control_points;
  options.directions = directions.ordinates;
  options.fit.delta_m_order = directions.delta_m_order;
  options.fit.exact_moments = directions.exact_moments;
  options.fit.beam_half_range_rows = directions.beam_half_range_rows;
  options.fit.minimax = true;
}

// Independent columns, with the directions of the solve.
SolverOptions ordinates_of_columns(const SolverOptions& options) {
  SolverOptions columns = options;
  ask_for_fluxes_alone(columns);
  // The probe's levels are subdivided already, so that listed ones have other indices there.
  columns.max_level_optical_depth = 0;
  if (columns.flux_levels == FluxLevels::listed) columns.flux_levels = FluxLevels::all;
  columns.collapse_uniform_axes = false;
  columns.independent_columns = true;
  columns.radiance_field = true;                          // which is known by ordinates alone
  columns.tolerance = std::max(options.tolerance, 5e-4);  // their errors are some per mille or more
  return columns;
}

SolverOptions streams_of_columns(const SolverOptions& options) {
  SolverOptions columns = ordinates_of_columns(options);
  columns.radiance_field = false;
  columns.column_streams = most_streams;
  return columns;
}

// Levels between the ends at which the worst distance is looked for. That of the constant source changes evenly with
// height, that of few directions does not.
constexpr std::size_t most_levels_between = 16;
constexpr std::size_t most_levels_of_constant = 6;

// The ends, and some of the levels between that border matter: elsewhere light hardly changes.
std::vector<int> some_levels(const OpticalGrid& grid, const std::vector<int>& levels, std::size_t most) {
  if (levels.size() <= most + 2) return levels;
  const auto has_matter = [&grid](int k) { return grid.first_cell(k + 1) > grid.first_cell(k); };
  std::vector<int> between;
  for (std::size_t n = 1; n + 1 < levels.size(); ++n) {
    if (has_matter(levels[n] - 1) || has_matter(levels[n])) between.push_back(levels[n]);
  }
  std::vector<int> some{levels.front()};
  const std::size_t count = std::min(between.size(), most);
  for (std::size_t n = 0; n < count; ++n) some.push_back(between[(2 * n + 1) * between.size() / (2 * count)]);
  some.push_back(levels.back());
  return some;
}

void list_some_levels(const SolvePlan& plan, std::size_t most, SolverOptions& options) {
  const OpticalGrid& grid = plan.whole().grid;
  options.listed_levels = some_levels(grid, flux_levels(grid.box, options), most);
  options.flux_levels = FluxLevels::listed;
}

SolvePlan with_constant_source(const SolvePlan& plan, const SolvePlan& coarse, SolvedAs as) {
  SolverOptions constant = coarse.whole_options();
  constant.linear_source = false;
  if (as != SolvedAs::field) return coarse.with(constant);
  list_some_levels(plan, most_levels_of_constant, constant);
  // It starts from the light of the linear one. With half of this tolerance, estimates of clouds were the same.
  constant.tolerance *= 2;
  constant.energy_tolerance = 1e-2;
  return coarse.with(constant);
}

SolverOptions coarse_options(const SolverOptions& options, const std::string& accuracy, SolvedAs as) {
  SolverOptions other = options;
  const int beyond = options.fit.beam_delta_m_order - options.fit.delta_m_order;
  other.column_streams = as == SolvedAs::field                   ? streams_of_field(options.column_streams)
                         : as == SolvedAs::column_beside_streams ? most_streams
                                                                 : streams_of_column(options.column_streams);
  if (as == SolvedAs::column_beside_streams) {
    other.independent_columns = true;
  } else if (as == SolvedAs::column) {
    set_directions(accuracy == "draft"      ? column_directions_of_draft
                   : accuracy == "balanced" ? column_directions_of_balanced
                                            : column_directions,
                   other);
  } else if (as == SolvedAs::field) {
    set_directions(field_directions, other);
    other.gather_directions = std::min(options.gather_directions, 32);
    other.beam_rays = 1;
    other.tolerance = std::max(options.tolerance, coarse_tolerance);
    other.energy_tolerance = coarse_energy_tolerance;
  }
  other.fit.beam_delta_m_order = other.fit.delta_m_order + beyond;
  ask_for_fluxes_alone(other);
  return other;
}

}  // namespace

SolvePlan coarse_plan(const SolvePlan& plan, const std::string& accuracy, SolvedAs as) {
  SolverOptions options = coarse_options(plan.whole_options(), accuracy, as);
  if (as == SolvedAs::field && !options.independent_columns) list_some_levels(plan, most_levels_between, options);
  return plan.with(options);
}

CoarseSolves solve_coarsely(const SolvePlan& plan, const SolvePlan& coarse, SolvedAs as,
                            const ProgressCallback& progress, CellLight light, Ranks* ranks) {
  CoarseSolves coarse_solves;
  const auto solve_one = [&](const SolvePlan& one, CellLight* from) {
    return solve(one, progress, {.ranks = ranks, .light = from});
  };
  coarse_solves.linear = solve_one(coarse, &light);
  if (coarse.by_polar_streams()) {  // exact in the vertical
    coarse_solves.constant = coarse_solves.linear;
    coarse_solves.constant.report = {};  // one solve
    return coarse_solves;
  }
  coarse_solves.constant = solve_one(with_constant_source(plan, coarse, as), &light);
  if (as != SolvedAs::field) return coarse_solves;
  light = {};
  const Problem columns = probe_columns(plan);
  const SolverOptions& options = plan.whole_options();
  const SolvePlan by_ordinates(columns, ordinates_of_columns(options));
  coarse_solves.probe = {solve_one(by_ordinates, nullptr),
                         solve_one(by_ordinates.with(streams_of_columns(options)), nullptr)};
  return coarse_solves;
}

double predict_coarse_seconds(const SolvePlan& plan, const SolvePlan& coarse, SolvedAs as) {
  if (coarse.by_polar_streams()) return predict_seconds(coarse);
  const auto seconds_of = [as](const SolvePlan& one) {
    constexpr double sweeps_from_light = 5;  // those of fields start from the light of the solution
    SolveSeconds seconds = predict_phases(one);
    if (as == SolvedAs::field) seconds.sweeps = std::min(seconds.sweeps, sweeps_from_light);
    return seconds.total();
  };
  const double seconds = seconds_of(coarse) + seconds_of(with_constant_source(plan, coarse, as));
  if (as != SolvedAs::field) return seconds;
  const Problem columns = probe_columns(plan);  // by ordinates; streams take next to nothing
  return seconds + predict_seconds(SolvePlan(columns, ordinates_of_columns(plan.whole_options())));
}

}  // namespace cloudbow
