#include "cloudbow/transport/solver.hpp"

#include <fmt/format.h>
#include <omp.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <string>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/flush_denormals.hpp"
#include "cloudbow/core/thread_scope.hpp"
#include "cloudbow/medium/grid_map.hpp"
#include "cloudbow/transport/thick_cells.hpp"
#include "transport/columns/columns.hpp"
#include "transport/driver/carried_light.hpp"
#include "transport/driver/path_load.hpp"
#include "transport/iteration/first_guess.hpp"
#include "transport/observers/cell_fields.hpp"
#include "transport/observers/circumsolar.hpp"
#include "transport/observers/converged_field.hpp"
#include "transport/observers/flux_fields.hpp"
#include "transport/observers/images.hpp"
#include "transport/problem/finite.hpp"
#include "transport/reduction/subdivided_columns.hpp"
#include "transport/reduction/subdivided_levels.hpp"
#include "transport/reduction/uniform_axes.hpp"

namespace cloudbow {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// Memory of this program alone: getrusage also counts the process that started it.
std::size_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::size_t kibibytes = 0;
    if (word == "VmHWM:" && status >> kibibytes) return kibibytes * 1024;
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

bool one_column(const BoxGrid& box) { return box.periodic && box.columns() == 1; }

std::string mode_of(const BoxGrid& box, const SolverOptions& options) {
  if (one_column(box)) return "1d";
  if (options.independent_columns) return options.beam_crosses_columns ? "independent-diffuse" : "independent-columns";
  return box.periodic && (box.nx == 1 || box.ny == 1) ? "2d" : "3d";
}

/// Light that comes in through open sides along each ordinate, in marching order, as TransportSystem::side_radiance.
template <class Real>
std::vector<std::vector<Real>> side_radiance(const LateralBoundary& lateral_boundary, const OrdinateSet& ordinates) {
  std::vector<std::vector<Real>> radiance;
  for (const Direction& d : ordinates.direction) {
    const auto by_height = lateral_boundary.radiance(d);
    radiance.emplace_back(by_height.begin(), by_height.end());
    if (d.z() < 0) std::reverse(radiance.back().begin(), radiance.back().end());
  }
  return radiance;
}

/// Whether light enters through open sides: that of the sky, or light that layers scatter or ground or layers emit.
bool has_lit_sides(const Problem& problem, const SolverOptions& options) {
  if (problem.grid.box.periodic || options.independent_columns) return false;
  return problem.sky_radiance > 0 || problem.emits() ||
         std::any_of(problem.grid.layer_scattering.begin(), problem.grid.layer_scattering.end(),
                     [](const auto& s) { return *std::max_element(s.begin(), s.end()) > 0; });
}

template <class Real>
void report_iteration(const IterationResult<Real>& solved, Solution& solution) {
  SolverReport& report = solution.report;
  solution.ledger = solved.ledger;
  report.converged = solved.report.converged;
  report.stalled = solved.report.stalled;
  report.sweeps = solved.report.sweeps;
  report.estimated_error = solved.report.estimated_error;
  report.seconds_sweeps = solved.report.seconds_sweeps;
  report.seconds_scattering = solved.report.seconds_scattering;
  report.seconds_acceleration = solved.report.seconds_acceleration;
  report.radiance_storage = solved.radiance.packed()        ? "float16"
                            : sizeof(Real) == sizeof(float) ? "float32"
                                                            : "float64";
}

/// All that is computed from the converged field. All ranks that share it call this; the first has the solution.
/// @param result of the field: the source takes the memory of its radiance.
template <class Real>
void observe(const ConvergedField<Real>& field, IterationResult<Real>& result, const ProgressCallback& progress,
             Solution& solution) {
  const SolverOptions& options = field.options;
  const bool sees_sun = options.circumsolar_half_angle > 0 && field.problem.sun;
  const bool within_blocks = needs_light_within_blocks(field.system, options);
  const Images<Real> images(field);
  std::optional<CircumsolarLight<Real>> circumsolar;
  if (sees_sun) circumsolar.emplace(field);
  // Independent columns have their fluxes from the iteration.
  const bool gathers = result.fluxes.column_up.empty();
  std::optional<DirectionalSource<Real>> source;
  if (gathers || options.radiance_field) {
    source.emplace(scattered_source(field.discretisation, field.system, std::move(result.radiance)));
    share_source(field, options.radiance_field || within_blocks, *source);
  }
  fill_flux_fields(field, gathers ? &*source : nullptr, progress, solution);
  const std::size_t cells = field.share != nullptr ? field.share->range().size() : field.system.cells->size();
  std::vector<Real> scalar_flux(result.moments.begin(), result.moments.begin() + static_cast<std::ptrdiff_t>(cells));
  if (field.share != nullptr) {
    field.share->cells_to_first(scalar_flux);
    if (result.slopes && (sees_sun || !options.views.empty() || !options.cameras.empty()))
      field.share->cells_to_first(result.slopes->of_radiance);
    if (result.slopes && (sees_sun || within_blocks)) field.share->rows_to_first(result.slopes->of_octant);
    if (!field.share->is_first()) return;
  }
  images.fill(solution);
  if (circumsolar) {
    circumsolar->fill(solution);
  } else if (options.circumsolar_half_angle > 0) {
    solution.circumsolar_flux.assign(solution.direct_flux.size(), 0.F);
  }
  fill_cell_fields<Real>(field, source ? &*source : nullptr, scalar_flux, solution);
  if (options.radiance_field) solution.radiance_field = make_radiance_field(field, *source);
}

template <class Real>
Solution solve_as(const SolvePlan& plan, const Problem& problem, const ProgressCallback& progress,
                  const SolveMeans& means) {
  const SolverOptions& options = plan.options();
  const auto start = Clock::now();
  const double cpu_start = cpu_seconds();
  Solution solution;
  solution.box = problem.grid.box;
  solution.sun = problem.sun;
  solution.emits = problem.emits();
  SolverReport& report = solution.report;
  const auto report_phase = [&](const char* phase) {
    if (progress) progress({phase, report.sweeps, report.estimated_error, solution.ledger.residual, 0});
  };

  report_phase("tables");
  auto phase_start = Clock::now();
  const std::optional<Direction> sun = problem.sun ? std::optional<Direction>(problem.sun->travel) : std::nullopt;
  const Discretisation discretisation = discretise(problem.phase, sun, options);
  report.seconds_tables = seconds_since(phase_start);

  report_phase("beam");
  phase_start = Clock::now();
  std::optional<LateralBoundary> lateral_boundary;
  if (has_lit_sides(problem, options)) lateral_boundary.emplace(problem, discretisation, options);
  const TransportSystem<Real> system =
      make_system<Real>(problem, discretisation, options,
                        lateral_boundary ? side_radiance<Real>(*lateral_boundary, discretisation.ordinates)
                                         : std::vector<std::vector<Real>>{});
  report.seconds_beam = seconds_since(phase_start);

  std::optional<OrdinateShare> share;
  if (means.ranks != nullptr) share.emplace(*means.ranks, system.ordinates, system.cells->size());
  FirstGuess<Real> guess;
  if (means.light != nullptr && can_carry(*means.light, plan)) {
    if (&means.light->plan->problem() != &problem) *means.light = carried_light(std::move(*means.light), plan);
    guess = first_guess(system, problem.sun, std::move(*means.light), share ? &*share : nullptr);
  }
  IterationResult<Real> solved = iterate_source<Real>(
      system, options,
      [&](int sweep, double error, double residual) {
        if (progress) progress({"sweep", sweep, error, residual, 0});
      },
      means.checkpoints, share ? &*share : nullptr, std::move(guess));
  report_iteration(solved, solution);

  phase_start = Clock::now();
  const ConvergedField<Real> field{problem,
                                   discretisation,
                                   options,
                                   system,
                                   solved,
                                   lateral_boundary ? &*lateral_boundary : nullptr,
                                   share ? &*share : nullptr};
  observe(field, solved, progress, solution);
  if (means.light != nullptr) *means.light = cell_light(system, plan, std::move(solved), field.share);
  if (!field.is_first()) return {};
  report.seconds_gather = seconds_since(phase_start);

  report.control_points = options.control_points;
  report.directions = discretisation.ordinates.name;
  report.mode = mode_of(problem.grid.box, options);
  report.active_voxels = problem.grid.active_cells();
  report.threads = omp_get_max_threads();
  for (const auto& table : discretisation.table) {
    report.fit_closure = std::max(report.fit_closure, table.report.closure);
    report.fit_max_error = std::max(report.fit_max_error, table.report.max_error);
    report.fit_fallbacks += table.report.fallbacks;
  }
  report.surface_largest_albedo = system.ground.largest_albedo();
  if (const auto& reflection = system.ground.table())
    report.surface_largest_correction = reflection->largest_correction;
  report.seconds_total = seconds_since(start);
  report.cpu_seconds = cpu_seconds() - cpu_start;
  report.peak_memory_bytes = peak_memory_bytes();
  return solution;
}

Solution solve_by_polar_streams(const SolvePlan& plan, const ProgressCallback& progress) {
  const auto start = Clock::now();
  const double cpu_start = cpu_seconds();
  const Problem& problem = plan.problem();
  Solution solution = plan.in_double() ? solve_columns<double>(problem, plan.options(), progress)
                                       : solve_columns<float>(problem, plan.options(), progress);
  SolverReport& report = solution.report;
  report.mode = mode_of(problem.grid.box, plan.options());
  report.active_voxels = problem.grid.active_cells();
  report.threads = omp_get_max_threads();
  report.seconds_total = report.seconds_sweeps = seconds_since(start);
  report.cpu_seconds = cpu_seconds() - cpu_start;
  report.peak_memory_bytes = peak_memory_bytes();
  return solution;
}

// @param grid with the columns of the result.
void report_air(const OpticalGrid& grid, SolverReport& report) {
  if (grid.box.columns() == 1) return;
  report.air_error = grid.air_error;
  for (int k = 0; k < grid.box.nz(); ++k) {
    double layers = grid.layer_absorption[k];
    for (const auto& scattering : grid.layer_scattering) layers += scattering[k];
    const AirBlocks air = grid.air_of(k);
    if (air.count() > 0) {
      const int narrow = std::min(air.width_x, air.width_y);
      report.air_block_columns = report.air_levels == 0 ? narrow : std::min(report.air_block_columns, narrow);
      ++report.air_levels;
    }
    if (layers > 0 || air.count() > 0) report.air = report.air_levels > 0 ? "levels" : "cells";
  }
}

// Planck radiances of ground and matter: 0 or within range, and not negative at any face of a cell.
void check_emission(const Problem& problem) {
  const auto check = [](double planck, double step) {
    const bool in_range = planck == 0 || (planck >= least_light && planck <= most_light);
    if (in_range && std::abs(step) <= 2 * planck * (1 + 1e-6)) return;
    throw InputError(fmt::format(
        "Planck radiance: out of range (found {}, step {}, allowed 0, or {:g} to {:g}, steps up to twice the radiance)",
        planck, step, least_light, most_light));
  };
  check(problem.surface.planck, 0);
  for (const float planck : problem.surface.planck_map) check(planck, 0);
  const OpticalGrid& grid = problem.grid;
  for (std::size_t c = 0; c < grid.planck.size(); ++c) check(grid.planck[c], grid.planck_step[c]);
}

void check_light(const Problem& problem) {
  const auto check = [](const char* what, double value) {
    if (value == 0 || (value >= least_light && value <= most_light)) return;
    throw InputError(
        fmt::format("{}: out of range (found {}, allowed 0, or {:g} to {:g})", what, value, least_light, most_light));
  };
  if (problem.sun) check("irradiance of the sun", problem.sun->irradiance);
  check("radiance of the sky", problem.sky_radiance);
  check_emission(problem);
}

Solution solve_by_ordinates(const SolvePlan& plan, const ProgressCallback& progress, SolveMeans means) {
  check_cell_thickness(plan.problem());
  const FlushDenormals flush;
  std::optional<Problem> with_all_cells;
  if (plan.cells() > plan.problem().grid.active_cells()) {
    with_all_cells = plan.problem();
    with_all_cells->grid = with_empty_cells(plan.problem().grid);
    means.light = nullptr;  // other solves do not have these cells
  }
  const Problem& problem = with_all_cells ? *with_all_cells : plan.problem();
  return plan.in_double() ? solve_as<double>(plan, problem, progress, means)
                          : solve_as<float>(plan, problem, progress, means);
}

// Light that stays in its column is solved in less time than it takes to send.
bool can_be_shared(const SolvePlan& plan) {
  return !plan.by_polar_streams() && !plan.options().independent_columns && !plan.is_one_column();
}

}  // namespace

Solution solve(const SolvePlan& plan, const ProgressCallback& progress, SolveMeans means) {
  check_light(plan.whole());
  const bool is_first = means.ranks == nullptr || means.ranks->is_first();
  if (!can_be_shared(plan)) {
    if (!is_first) return {};
    means.ranks = nullptr;
    means.light = nullptr;  // which all ranks would need
  }
  Solution solution;
  {
    const ThreadScope threads(plan.threads());
    check_paths(plan);
    solution =
        plan.by_polar_streams() ? solve_by_polar_streams(plan, progress) : solve_by_ordinates(plan, progress, means);
  }
  if (!is_first) return {};
  if (plan.column_parts().any()) {
    join_columns(plan.with_levels(), plan.column_parts(), solution);
    solution.report.column_parts_x = plan.column_parts().x;
    solution.report.column_parts_y = plan.column_parts().y;
  }
  report_air(plan.with_levels().grid, solution.report);
  if (plan.added_levels() > 0) {
    join_levels(plan.collapsed(), plan.levels(), solution);
    solution.report.added_levels = plan.added_levels();
  }
  if (const UniformAxes axes = plan.collapsed_axes(); axes.any()) {
    spread(plan.whole(), axes, solution);
    solution.report.collapsed_axes = axes.x && axes.y ? "x, y" : axes.x ? "x" : "y";
  }
  check_finite(solution);
  return solution;
}

Solution solve(const Problem& problem, const SolverOptions& options, const ProgressCallback& progress,
               Checkpoints* checkpoints) {
  return solve(SolvePlan(problem, options), progress, {.checkpoints = checkpoints});
}

}  // namespace cloudbow
