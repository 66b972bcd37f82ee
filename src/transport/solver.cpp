#include <omp.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "cloudbow/core/error.hpp"
#include "cloudbow/transport/discretisation.hpp"
#include "cloudbow/transport/gather.hpp"
#include "cloudbow/transport/source_iteration.hpp"

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

std::size_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

bool one_column(const BoxGrid& box) { return box.periodic && box.columns() == 1; }

// Extinction of the active cells when the fraction f_p of what phase function p scatters counts as unscattered.
template <class Real>
std::vector<Real> scaled_extinction(const OpticalGrid& grid, const std::vector<double>& forward_fraction) {
  std::vector<Real> extinction(grid.active_cells());
  for (std::size_t c = 0; c < extinction.size(); ++c) {
    double sum = grid.absorption[c];
    for (std::size_t p = 0; p < grid.scattering.size(); ++p) sum += (1 - forward_fraction[p]) * grid.scattering[p][c];
    extinction[c] = static_cast<Real>(sum);
  }
  return extinction;
}

std::vector<double> scaled_layer_extinction(const OpticalGrid& grid, const std::vector<double>& forward_fraction) {
  std::vector<double> extinction = grid.layer_absorption;
  for (std::size_t p = 0; p < grid.layer_scattering.size(); ++p) {
    for (std::size_t k = 0; k < extinction.size(); ++k)
      extinction[k] += (1 - forward_fraction[p]) * grid.layer_scattering[p][k];
  }
  return extinction;
}

template <class Real>
DirectBeam<Real> beam_with(const Problem& problem, const ActiveRows& rows, const std::vector<double>& forward_fraction,
                           const SolverOptions& options) {
  const std::vector<Real> extinction = scaled_extinction<Real>(problem.grid, forward_fraction);
  return direct_beam<Real>(problem.grid.box, rows, extinction, scaled_layer_extinction(problem.grid, forward_fraction),
                           *problem.sun, {options.beam_rays, options.independent_columns});
}

template <class Real>
TransportSystem<Real> make_system(const Problem& problem, const Discretisation& discretisation,
                                  const SolverOptions& options) {
  TransportSystem<Real> system;
  system.box = problem.grid.box;
  system.vertical = options.independent_columns;
  system.cells = make_cells<Real>(problem.grid, discretisation.diffuse_fraction(), system.vertical);
  system.ordinates = discretisation.ordinates;
  for (std::size_t p = 0; p < discretisation.table.size(); ++p) {
    system.scattering.push_back(
        rounded_conservatively<Real>(discretisation.table[p].ordinates_from_ordinates, system.ordinates.weight));
    system.truncated_asymmetry.push_back(discretisation.diffuse[p].truncated.asymmetry_parameter());
  }
  system.absorption.assign(problem.grid.absorption.begin(), problem.grid.absorption.end());
  system.sky_radiance = problem.sky_radiance;
  system.surface_albedo = problem.surface_albedo;
  system.power_in = std::numbers::pi * problem.sky_radiance;
  if (problem.sun) {
    system.power_in += -problem.sun->travel.z() * problem.sun->irradiance;
    const std::vector<double> fraction = discretisation.beam_fraction();
    DirectBeam<Real> beam = beam_with<Real>(problem, system.cells.rows, fraction, options);
    for (std::size_t p = 0; p < discretisation.table.size(); ++p) {
      BeamSource<Real> source;
      source.direction = discretisation.table[p].ordinates_from_beam.template cast<Real>();
      source.intensity.resize(system.cells.size());
      bool any = false;
      for (std::size_t c = 0; c < source.intensity.size(); ++c) {
        const double scattered = (1 - fraction[p]) * problem.grid.scattering[p][c];
        any = any || scattered > 0;
        source.intensity[c] = scattered > 0 ? static_cast<Real>(scattered * static_cast<double>(beam.irradiance[c]) /
                                                                static_cast<double>(system.cells.extinction[c]))
                                            : Real(0);
      }
      if (any) system.beam.push_back(std::move(source));
    }
    system.beam_surface_flux.assign(beam.level_flux.begin(),
                                    beam.level_flux.begin() + static_cast<std::ptrdiff_t>(system.box.columns()));
    system.beam_side_gain = beam.side_gain;
    system.beam_side_loss = beam.side_loss;
    system.beam_irradiance = std::move(beam.irradiance);
  }
  return system;
}

// Source in any direction of the converged radiance. The beam that lights it is the one truncated at the gather's
// order; light that the iteration's own truncation calls unscattered but that one does not is added with the truncated
// phase function (theory.md, "The peak on the true beam").
template <class Real>
DirectionalSource<Real> make_directional_source(const Problem& problem, const Discretisation& discretisation,
                                                const TransportSystem<Real>& system, const AngularField<Real>& radiance,
                                                const DirectBeam<Real>* gather_beam, const SolverOptions& options) {
  DirectionalSource<Real> source{discretisation.points,
                                 AngularField<Real>(discretisation.points.size(), system.cells.size()),
                                 -Direction::UnitZ(),
                                 {}};
  std::vector<DenseMatrix<Real>> to_points;
  for (const auto& table : discretisation.table) to_points.push_back(table.points_from_ordinates.template cast<Real>());
  scatter_to<Real>(radiance, to_points, system.cells, source.at_points);
  if (!problem.sun) return source;
  source.sun_travel = problem.sun->travel;
  const std::vector<double> gather_fraction = discretisation.gather_fraction();
  const std::vector<double> diffuse_fraction = discretisation.diffuse_fraction();
  const DirectBeam<Real> scaled = beam_with<Real>(problem, system.cells.rows, diffuse_fraction, options);
  for (std::size_t p = 0; p < discretisation.table.size(); ++p) {
    SingleScattering<Real> first{discretisation.gather[p].truncated, std::vector<Real>(system.cells.size())};
    SingleScattering<Real> unscattered{discretisation.diffuse[p].truncated, std::vector<Real>(system.cells.size())};
    bool any = false;
    for (std::size_t c = 0; c < system.cells.size(); ++c) {
      const double scattering = problem.grid.scattering[p][c];
      if (scattering == 0) continue;
      any = true;
      const double per_extinction =
          scattering / static_cast<double>(system.cells.extinction[c]) / (4 * std::numbers::pi);
      const double beam = static_cast<double>(gather_beam->irradiance[c]);
      first.intensity[c] = static_cast<Real>((1 - gather_fraction[p]) * per_extinction * beam);
      unscattered.intensity[c] = static_cast<Real>((1 - diffuse_fraction[p]) * per_extinction *
                                                   std::max(0., static_cast<double>(scaled.irradiance[c]) - beam));
    }
    if (!any) continue;
    source.first_order.push_back(std::move(first));
    if (diffuse_fraction[p] > gather_fraction[p]) source.first_order.push_back(std::move(unscattered));
  }
  return source;
}

// What an open side shows: the layers by themselves over a black surface, solved as one column.
class Surroundings {
 public:
  Surroundings(const Problem& problem, const Discretisation& discretisation, const SolverOptions& options)
      : problem_{layers_only(problem.grid), problem.phase, problem.sun, problem.sky_radiance, 0.} {
    SolverOptions column = options;
    column.independent_columns = false;
    system_ = make_system<double>(problem_, discretisation, column);
    IterationResult<double> solved =
        iterate_source(system_, {options.tolerance, options.energy_tolerance, options.max_sweeps}, {});
    std::optional<DirectBeam<double>> beam;
    if (problem_.sun) beam = beam_with<double>(problem_, system_.cells.rows, discretisation.gather_fraction(), column);
    source_.emplace(
        make_directional_source(problem_, discretisation, system_, solved.radiance, beam ? &*beam : nullptr, column));
  }

  /// Diffuse radiance along a direction at each interface, by height.
  std::vector<double> radiance(const Direction& travel) const {
    const PathPattern pattern = make_path_pattern(system_.box, travel, .5, .5, true, {0, system_.box.nz()});
    std::vector<double> at_edge(system_.box.nz() + 1, 0.);
    std::vector<double> source(system_.cells.size());
    source_->query(travel, source.data());
    std::vector<double> ray(1, travel.z() < 0 ? problem_.sky_radiance : 0.);
    MarchWorkspace<double> work;
    march<double, false>(
        pattern, system_.cells, true, {}, source.data(), ray.data(), work,
        [&](int step, const double* p) { at_edge[pattern.upward ? step : system_.box.nz() - step] = *p; });
    return at_edge;
  }

 private:
  Problem problem_;
  TransportSystem<double> system_;
  std::optional<DirectionalSource<double>> source_;
};

// Every cell of the box active: the radiance of empty air is asked for too.
OpticalGrid with_empty_cells(const OpticalGrid& grid) {
  OpticalGrid full;
  full.box = grid.box;
  full.layer_absorption = grid.layer_absorption;
  full.layer_scattering = grid.layer_scattering;
  const auto dense = dense_indices(active_rows(grid));
  const std::size_t cells = grid.box.columns() * static_cast<std::size_t>(grid.box.nz());
  full.absorption.assign(cells, 0.F);
  full.scattering.assign(grid.scattering.size(), std::vector<float>(cells, 0.F));
  for (std::size_t c = 0; c < dense.size(); ++c) {
    full.absorption[dense[c]] = grid.absorption[c];
    for (std::size_t p = 0; p < grid.scattering.size(); ++p) full.scattering[p][dense[c]] = grid.scattering[p][c];
  }
  for (int row = 0; row < grid.box.nz() * grid.box.ny; ++row) {
    full.row_begin.push_back(static_cast<std::uint32_t>(row));
    full.spans.push_back({0, grid.box.nx, static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(grid.box.nx)});
  }
  full.row_begin.push_back(static_cast<std::uint32_t>(full.spans.size()));
  return full;
}

std::vector<int> flux_levels(const BoxGrid& box, const SolverOptions& options) {
  if (options.flux_levels == FluxLevels::boundaries) return {0, box.nz()};
  if (options.flux_levels == FluxLevels::listed) return options.listed_levels;
  std::vector<int> all(box.nz() + 1);
  for (int e = 0; e <= box.nz(); ++e) all[e] = e;
  return all;
}

double mean(const std::vector<double>& field) {
  double sum = 0;
  for (const double f : field) sum += f;
  return sum / static_cast<double>(field.size());
}

// Fluxes of one interface, column by column.
struct LevelFlux {
  std::vector<double> up;
  std::vector<double> down;  // diffuse beside gather_direct
};

// Turns the converged radiance into fluxes through planes: by the gather where columns exchange light, by the ordinates
// themselves where they do not.
template <class Real>
class FluxFields {
 public:
  FluxFields(const Problem& problem, const Discretisation& discretisation, const SolverOptions& options,
             const TransportSystem<Real>& system, const IterationResult<Real>& solved, const Surroundings* surroundings,
             const ProgressCallback& progress)
      : problem_(problem),
        options_(options),
        system_(system),
        solved_(solved),
        progress_(progress),
        columns_(system.box.columns()) {
    const bool by_ordinates = !solved.fluxes.column_up.empty();
    if (problem.sun) {
      true_beam_ = beam_with<Real>(problem, system.cells.rows, std::vector<double>(problem.phase.size(), 0.), options);
      // Columns by themselves keep the iteration's own beam: their fluxes are the iteration's.
      flux_beam_ =
          beam_with<Real>(problem, system.cells.rows,
                          by_ordinates ? discretisation.beam_fraction() : discretisation.gather_fraction(), options);
      solver_beam_ = by_ordinates
                         ? flux_beam_
                         : beam_with<Real>(problem, system.cells.rows, discretisation.beam_fraction(), options);
    }
    if (!by_ordinates) {
      source_.emplace(make_directional_source(problem, discretisation, system, solved.radiance,
                                              problem.sun ? &*flux_beam_ : nullptr, options));
      if (surroundings != nullptr)
        side_radiance_ = [surroundings](const Direction& travel) { return surroundings->radiance(travel); };
    }
  }

  void fill(Solution& solution) {
    fill_profiles(solution);
    solution.flux_level = flux_levels(system_.box, options_);
    if (source_) {
      gather_ends(solution);
    }
    for (auto* field : {&solution.upwelling_flux, &solution.downwelling_diffuse_flux, &solution.direct_flux}) {
      field->reserve(columns_ * solution.flux_level.size());
    }
    std::vector<float> inner_up, inner_down;
    const bool inner = source_ && options_.flux_levels == FluxLevels::all && system_.box.nz() > 1;
    if (inner) {
      const auto scene = gather_scene();
      const int count = std::max(32, options_.gather_directions / 2);
      inner_down = march_level_fluxes<Real>(scene, false, gather_directions(count, false, sun_direction()));
      report_progress(.75);
      inner_up = march_level_fluxes<Real>(scene, true, gather_directions(count, true, std::nullopt));
    }
    for (const int edge : solution.flux_level) {
      LevelFlux flux;
      if (!source_) {
        flux.up = slice(solved_.fluxes.column_up, edge);
        flux.down = slice(solved_.fluxes.column_down, edge);
      } else if (inner && edge > 0 && edge < system_.box.nz()) {
        flux.up.assign(inner_up.begin() + static_cast<std::ptrdiff_t>(edge * columns_),
                       inner_up.begin() + static_cast<std::ptrdiff_t>((edge + 1) * columns_));
        flux.down.assign(inner_down.begin() + static_cast<std::ptrdiff_t>(edge * columns_),
                         inner_down.begin() + static_cast<std::ptrdiff_t>((edge + 1) * columns_));
        rescale(flux.up, profile_up(edge));
        rescale(flux.down, profile_down(edge));
      } else {
        flux = plane(edge, solution);
      }
      append(solution, edge, flux);
    }
  }

 private:
  std::optional<Direction> sun_direction() const {
    if (!problem_.sun) return std::nullopt;
    return problem_.sun->travel;
  }

  GatherScene<Real> gather_scene() const {
    return {system_.box, system_.cells, *source_, side_radiance_, problem_.sky_radiance, surface_radiance_};
  }

  void report_progress(double fraction) const {
    if (progress_)
      progress_({"gather", solved_.report.sweeps, solved_.report.estimated_error, solved_.ledger.residual, fraction});
  }

  std::vector<double> slice(const std::vector<double>& levels, int edge) const {
    const auto first = levels.begin() + static_cast<std::ptrdiff_t>(edge * columns_);
    return {first, first + static_cast<std::ptrdiff_t>(columns_)};
  }

  double profile_up(int edge) const { return solved_.fluxes.profile_up[edge]; }
  // Diffuse as the gather counts it: what its own beam does not carry.
  double profile_down(int edge) const {
    double total = solved_.fluxes.profile_down[edge];
    if (problem_.sun) total += mean(slice(solver_beam_->level_flux, edge)) - mean(slice(flux_beam_->level_flux, edge));
    return total;
  }

  // Scales a gathered field to the mean that the conservative iteration found; returns the factor.
  static double rescale(std::vector<double>& field, double wanted) {
    const double found = mean(field);
    const double factor = found > 0 && wanted > 0 ? wanted / found : 1;
    for (double& f : field) f *= factor;
    return factor;
  }

  void note_factor(Solution& solution, double factor) const {
    if (std::abs(factor - 1) > std::abs(solution.report.gather_rescaling - 1))
      solution.report.gather_rescaling = factor;
  }

  void gather_ends(Solution& solution) {
    surface_radiance_.assign(columns_, Real(0));
    report_progress(0);
    bottom_down_ = gather_flux<Real>(gather_scene(), 0, false,
                                     gather_directions(options_.gather_directions, false, sun_direction()));
    note_factor(solution, rescale(bottom_down_, profile_down(0)));
    for (std::size_t c = 0; c < columns_; ++c) {
      const double direct = problem_.sun ? flux_beam_->level_flux[c] : 0;
      surface_radiance_[c] = static_cast<Real>(problem_.surface_albedo / std::numbers::pi * (bottom_down_[c] + direct));
    }
    report_progress(.25);
    top_up_ = gather_flux<Real>(gather_scene(), system_.box.nz(), true,
                                gather_directions(options_.gather_directions, true, std::nullopt));
    note_factor(solution, rescale(top_up_, profile_up(system_.box.nz())));
    report_progress(.5);
  }

  LevelFlux plane(int edge, Solution& solution) const {
    LevelFlux flux;
    const int top = system_.box.nz();
    if (edge == 0) {
      flux.down = bottom_down_;
      flux.up.resize(columns_);
      for (std::size_t c = 0; c < columns_; ++c)
        flux.up[c] = std::numbers::pi * static_cast<double>(surface_radiance_[c]);
    } else if (edge == top) {
      flux.up = top_up_;
      flux.down.assign(columns_, std::numbers::pi * problem_.sky_radiance);
    } else {
      flux.up = gather_flux<Real>(gather_scene(), edge, true,
                                  gather_directions(options_.gather_directions, true, std::nullopt));
      flux.down = gather_flux<Real>(gather_scene(), edge, false,
                                    gather_directions(options_.gather_directions, false, sun_direction()));
      note_factor(solution, rescale(flux.up, profile_up(edge)));
      note_factor(solution, rescale(flux.down, profile_down(edge)));
    }
    return flux;
  }

  void append(Solution& solution, int edge, const LevelFlux& flux) const {
    for (std::size_t c = 0; c < columns_; ++c) {
      double direct = 0;
      double diffuse = flux.down[c];
      if (problem_.sun) {
        direct = true_beam_->level_flux[edge * columns_ + c];
        diffuse += std::max(0., flux_beam_->level_flux[edge * columns_ + c] - direct);
      }
      solution.upwelling_flux.push_back(static_cast<float>(flux.up[c]));
      solution.downwelling_diffuse_flux.push_back(static_cast<float>(diffuse));
      solution.direct_flux.push_back(static_cast<float>(direct));
    }
  }

  void fill_profiles(Solution& solution) const {
    const int levels = system_.box.nz() + 1;
    solution.profile_upwelling_flux = solved_.fluxes.profile_up;
    solution.profile_downwelling_diffuse_flux = solved_.fluxes.profile_down;
    solution.profile_direct_flux.assign(levels, 0.);
    if (!problem_.sun) return;
    for (int e = 0; e < levels; ++e) {
      const double direct = mean(slice(true_beam_->level_flux, e));
      solution.profile_direct_flux[e] = direct;
      solution.profile_downwelling_diffuse_flux[e] += mean(slice(solver_beam_->level_flux, e)) - direct;
    }
    solution.ledger.transmittance_direct = solution.profile_direct_flux[0] / system_.power_in;
  }

  const Problem& problem_;
  const SolverOptions& options_;
  const TransportSystem<Real>& system_;
  const IterationResult<Real>& solved_;
  const ProgressCallback& progress_;
  std::size_t columns_;
  SideRadiance side_radiance_;
  std::optional<DirectBeam<Real>> true_beam_;    // true extinction: what is reported as direct
  std::optional<DirectBeam<Real>> flux_beam_;    // what the fluxes here count as direct
  std::optional<DirectBeam<Real>> solver_beam_;  // what the iteration counted as direct
  std::optional<DirectionalSource<Real>> source_;
  std::vector<Real> surface_radiance_;
  std::vector<double> bottom_down_;
  std::vector<double> top_up_;
};

template <class Real>
void fill_cell_fields(const Problem& problem, const SolverOptions& options, const TransportSystem<Real>& system,
                      const IterationResult<Real>& solved, Solution& solution) {
  const auto dense = dense_indices(system.cells.rows);
  const std::size_t cells = system.box.columns() * static_cast<std::size_t>(system.box.nz());
  if (options.absorption) solution.absorbed_power.assign(cells, 0.F);
  if (options.actinic) solution.actinic_flux.assign(cells, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t c = 0; c < dense.size(); ++c) {
    const double actinic =
        static_cast<double>(solved.moments[c]) + (problem.sun ? static_cast<double>(system.beam_irradiance[c]) : 0.);
    if (options.absorption) solution.absorbed_power[dense[c]] = static_cast<float>(system.absorption[c] * actinic);
    if (options.actinic) solution.actinic_flux[dense[c]] = static_cast<float>(actinic);
  }
}

// Voxel-mean radiance of the delta-scaled problem along the control points of a frame in which none is horizontal.
template <class Real>
RadianceField make_radiance_field(const Problem& problem, const Discretisation& discretisation,
                                  const SolverOptions& options, const TransportSystem<Real>& system,
                                  const IterationResult<Real>& solved, const Surroundings* surroundings) {
  std::optional<DirectBeam<Real>> beam;
  if (problem.sun) beam = beam_with<Real>(problem, system.cells.rows, discretisation.gather_fraction(), options);
  const DirectionalSource<Real> source =
      make_directional_source(problem, discretisation, system, solved.radiance, beam ? &*beam : nullptr, options);
  const ControlPoints points(options.control_points, control_point_frame_rotation());
  RadianceField field;
  field.direction.assign(points.directions().begin(), points.directions().end());
  const std::size_t n = system.cells.size();
  const std::size_t m = field.direction.size();
  const std::size_t columns = system.box.columns();
  for (const std::uint32_t c : dense_indices(system.cells.rows)) {
    field.voxel.push_back({static_cast<std::int32_t>(c % system.box.nx),
                           static_cast<std::int32_t>(c / system.box.nx % system.box.ny),
                           static_cast<std::int32_t>(c / columns)});
  }
  field.radiance.resize(n * m);
#pragma omp parallel
  {
    MarchWorkspace<Real> work;
    std::vector<Real> radiance(n);
#pragma omp for schedule(dynamic, 1)
    for (std::size_t d = 0; d < m; ++d) {
      const Direction& travel = field.direction[d];
      const StartFraction start = start_for_centred_exit(system.box, travel, system.vertical);
      const PathPattern pattern =
          make_path_pattern(system.box, travel, start.x, start.y, system.vertical, {0, system.box.nz()});
      std::vector<Real> rays(columns, static_cast<Real>(problem.sky_radiance));
      if (pattern.upward) {
        for (std::size_t c = 0; c < columns; ++c) {
          rays[c] = static_cast<Real>(problem.surface_albedo / std::numbers::pi * solved.fluxes.surface_flux[c]);
        }
      }
      std::vector<Real> side;
      if (surroundings != nullptr) {
        const auto by_height = surroundings->radiance(travel);
        side.assign(by_height.begin(), by_height.end());
        if (!pattern.upward) std::reverse(side.begin(), side.end());
      }
      source.query(travel, radiance.data());
      march<Real, true>(pattern, system.cells, system.box.periodic, side, radiance.data(), rays.data(), work,
                        [](int, const Real*) {});
      for (std::size_t c = 0; c < n; ++c) field.radiance[c * m + d] = static_cast<float>(radiance[c]);
    }
  }
  return field;
}

std::string mode_of(const BoxGrid& box, const SolverOptions& options) {
  if (one_column(box)) return "1d";
  if (options.independent_columns) return "independent-columns";
  return box.periodic && (box.nx == 1 || box.ny == 1) ? "2d" : "3d";
}

template <class Real>
Solution solve_as(const Problem& problem, const SolverOptions& options, const ProgressCallback& progress) {
  const auto start = Clock::now();
  const double cpu_start = cpu_seconds();
  Solution solution;
  solution.box = problem.grid.box;
  SolverReport& report = solution.report;
  const auto tell = [&](const char* phase, double fraction) {
    if (progress) progress({phase, report.sweeps, report.estimated_error, solution.ledger.residual, fraction});
  };

  tell("tables", 0);
  auto phase_start = Clock::now();
  const std::optional<Direction> sun = problem.sun ? std::optional<Direction>(problem.sun->travel) : std::nullopt;
  const Discretisation discretisation = discretise(problem.phase, sun, options);
  report.seconds_tables = seconds_since(phase_start);

  tell("beam", 0);
  phase_start = Clock::now();
  TransportSystem<Real> system = make_system<Real>(problem, discretisation, options);
  std::optional<Surroundings> surroundings;
  const bool lit_from_outside = problem.sky_radiance > 0 ||
                                std::any_of(problem.grid.layer_scattering.begin(), problem.grid.layer_scattering.end(),
                                            [](const auto& s) { return *std::max_element(s.begin(), s.end()) > 0; });
  if (!problem.grid.box.periodic && !options.independent_columns && lit_from_outside) {
    surroundings.emplace(problem, discretisation, options);
    for (const Direction& d : system.ordinates.direction) {
      const auto by_height = surroundings->radiance(d);
      system.side_radiance.emplace_back(by_height.begin(), by_height.end());
      if (d.z() < 0) std::reverse(system.side_radiance.back().begin(), system.side_radiance.back().end());
    }
  }
  report.seconds_beam = seconds_since(phase_start);

  const IterationResult<Real> solved =
      iterate_source<Real>(system, {options.tolerance, options.energy_tolerance, options.max_sweeps},
                           [&](int sweep, double error, double residual) {
                             if (progress) progress({"sweep", sweep, error, residual, 0});
                           });
  solution.ledger = solved.ledger;
  report.converged = solved.report.converged;
  report.sweeps = solved.report.sweeps;
  report.estimated_error = solved.report.estimated_error;
  report.seconds_sweeps = solved.report.seconds_sweeps;
  report.seconds_scattering = solved.report.seconds_scattering;
  report.seconds_acceleration = solved.report.seconds_acceleration;

  phase_start = Clock::now();
  FluxFields<Real>(problem, discretisation, options, system, solved, surroundings ? &*surroundings : nullptr, progress)
      .fill(solution);
  fill_cell_fields(problem, options, system, solved, solution);
  if (options.radiance_field) {
    solution.radiance_field =
        make_radiance_field(problem, discretisation, options, system, solved, surroundings ? &*surroundings : nullptr);
  }
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
  report.seconds_total = seconds_since(start);
  report.cpu_seconds = cpu_seconds() - cpu_start;
  report.peak_memory_bytes = peak_memory_bytes();
  return solution;
}

// In a cell this thick the radiance differs from the source by less than float can tell, and the acceleration amplifies
// what rounding leaves: such fields converge in double alone (measured: cells of optical depth 25 are fine in float,
// 250 are not).
constexpr double thickest_cell_in_float = 50;

bool runs_in_double(const Problem& problem, const SolverOptions& options) {
  if (options.double_precision) return true;
  const BoxGrid& box = problem.grid.box;
  const ActiveRows rows = active_rows(problem.grid);
  for (int k = 0; k < box.nz(); ++k) {
    const double edge = std::min(
        {box.thickness_m(k), box.nx > 1 ? box.dx_m : box.thickness_m(k), box.ny > 1 ? box.dy_m : box.thickness_m(k)});
    for (std::uint32_t c = rows.level_cell[k]; c < rows.level_cell[k + 1]; ++c) {
      double extinction = problem.grid.absorption[c];
      for (const auto& scattering : problem.grid.scattering) extinction += scattering[c];
      if (extinction * edge > thickest_cell_in_float) return true;
    }
  }
  return false;
}

}  // namespace

Solution solve(const Problem& problem, const SolverOptions& options, const ProgressCallback& progress) {
  const int threads = options.threads > 0 ? options.threads : omp_get_num_procs();
  // A column or two is solved sooner than threads are woken; the bits are the same.
  constexpr std::size_t worth_threads = 2000;
  omp_set_num_threads(problem.grid.active_cells() < worth_threads ? 1 : threads);
  const std::size_t cells = problem.grid.box.columns() * static_cast<std::size_t>(problem.grid.box.nz());
  if (options.actinic && problem.grid.active_cells() < cells) {
    Problem full = problem;
    full.grid = with_empty_cells(problem.grid);
    return runs_in_double(full, options) ? solve_as<double>(full, options, progress)
                                         : solve_as<float>(full, options, progress);
  }
  return runs_in_double(problem, options) ? solve_as<double>(problem, options, progress)
                                          : solve_as<float>(problem, options, progress);
}

std::size_t predict_memory(const Problem& problem, const SolverOptions& options) {
  const std::size_t dense = problem.grid.box.columns() * static_cast<std::size_t>(problem.grid.box.nz());
  const std::size_t active = options.actinic ? dense : problem.grid.active_cells();
  const std::size_t real = runs_in_double(problem, options) ? sizeof(double) : sizeof(float);
  const std::size_t phases = problem.phase.size();
  const auto ordinates = static_cast<std::size_t>(make_ordinate_set(options.directions).size());
  const auto points = static_cast<std::size_t>(options.control_points);
  const auto threads = static_cast<std::size_t>(options.threads > 0 ? options.threads : omp_get_max_threads());
  // Grid, cells with their neighbours, and the beams.
  const std::size_t system =
      active * (4 * (1 + phases) + real * (1 + 2 * phases) + 3 * (8 + real) + 8 + 2 * real) + dense * 8;
  const std::size_t iteration = iteration_memory(active, dense, static_cast<int>(ordinates), real);
  // While the gather runs: radiance at the ordinates, source at the points, a direction's work arrays on each thread.
  const std::size_t gather =
      active * real * (ordinates + points + 4 * phases + 4 * threads + 4) + dense * (8 * 3 + 4 * 10 + 12);
  const std::size_t radiance_field = options.radiance_field ? active * (points * 4 + 12) : 0;
  constexpr std::size_t program = 60'000'000;  // libraries, tables, the cloud as read
  return program + system + std::max(iteration, gather) + radiance_field;
}

double predict_seconds(const Problem& problem, const SolverOptions& options) {
  // Segments a voxel and direction grow with the slant of the ordinates; constants measured with AVX2 on one core.
  constexpr double seconds_a_segment = 2.5e-9;
  constexpr double seconds_a_cell_and_direction = 6e-9;
  constexpr double seconds_a_multiply = 2.5e-11;
  constexpr int usual_sweeps = 16;
  const OrdinateSet ordinates = make_ordinate_set(options.directions);
  const BoxGrid& box = problem.grid.box;
  const double dz = (box.z_edge_m.back() - box.z_edge_m.front()) / box.nz();
  double segments = 0;
  for (const Direction& d : ordinates.direction)
    segments += 1 + (std::abs(d.x()) * dz / box.dx_m + std::abs(d.y()) * dz / box.dy_m) / std::abs(d.z());
  const double cells = static_cast<double>(options.actinic ? box.columns() * static_cast<std::size_t>(box.nz())
                                                           : problem.grid.active_cells());
  const double directions = ordinates.size();
  const double sweep = cells * (segments * seconds_a_segment + directions * seconds_a_cell_and_direction +
                                directions * directions * seconds_a_multiply);
  const double gather =
      cells * (3.5 * options.gather_directions) * (3 * seconds_a_segment + seconds_a_cell_and_direction);
  const int threads = options.threads > 0 ? options.threads : omp_get_max_threads();
  return (sweep * usual_sweeps + gather) / threads + .2;
}

}  // namespace cloudbow
