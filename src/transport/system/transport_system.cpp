#include "transport/system/transport_system.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "cloudbow/core/not_negative.hpp"
#include "transport/problem/power.hpp"

namespace cloudbow {
namespace {

std::vector<double> scaled_layer_extinction(const OpticalGrid& grid, const std::vector<double>& forward_fraction) {
  std::vector<double> extinction = grid.layer_absorption;
  for (std::size_t p = 0; p < grid.layer_scattering.size(); ++p) {
    for (std::size_t k = 0; k < extinction.size(); ++k)
      extinction[k] += (1 - forward_fraction[p]) * grid.layer_scattering[p][k];
  }
  return extinction;
}

}  // namespace

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

template <class Real>
DirectBeam<Real> beam_with(const Problem& problem, const ActiveRows& rows, const std::vector<double>& forward_fraction,
                           const SolverOptions& options, const BeamParts& parts) {
  const std::vector<Real> extinction = scaled_extinction<Real>(problem.grid, forward_fraction);
  return direct_beam<Real>(problem.grid.box, rows, extinction, scaled_layer_extinction(problem.grid, forward_fraction),
                           *problem.sun, {options.beam_rays, options.independent_columns, parts});
}

namespace {

template <class Real>
OrdinateScattering<Real> ordinate_scattering(const Discretisation& discretisation) {
  const OrdinateSet& ordinates = discretisation.ordinates;
  std::vector<DenseMatrix<Real>> matrix;
  for (const ScatteringTable& table : discretisation.table)
    matrix.push_back(rounded_conservatively<Real>(table.ordinates_from_ordinates, ordinates.weight));
  return {ordinates, std::move(matrix)};
}

template <class Real>
SystemBeam<Real> system_beam(const Problem& problem, const Discretisation& discretisation, const Cells<Real>& cells,
                             const SolverOptions& options, Slope<Real>* slope) {
  SystemBeam<Real> beam;
  if (!problem.sun) return beam;
  const std::vector<double> fraction = discretisation.beam_fraction();
  DirectBeam<Real> direct =
      beam_with<Real>(problem, cells.rows, fraction, options, {true, slope != nullptr, std::vector<int>{0}});
  if (slope != nullptr) *slope = std::move(direct.slope);
  for (std::size_t p = 0; p < discretisation.table.size(); ++p) {
    BeamSource<Real> source;
    source.direction = discretisation.table[p].ordinates_from_beam.template cast<Real>();
    source.intensity.resize(cells.size());
    bool any = false;
    for (std::size_t c = 0; c < source.intensity.size(); ++c) {
      const double scattered = (1 - fraction[p]) * problem.grid.scattering[p][c];
      any = any || scattered > 0;
      source.intensity[c] = scattered > 0 ? static_cast<Real>(scattered * static_cast<double>(direct.irradiance[c]) /
                                                              static_cast<double>(cells.extinction[c]))
                                          : Real(0);
    }
    if (any) beam.source.push_back(std::move(source));
  }
  beam.profile = std::move(direct.mean_flux);
  const std::span<const double> at_surface = direct.flux_at(0);
  beam.surface_flux.assign(at_surface.begin(), at_surface.end());
  beam.side_gain = direct.side_gain;
  beam.side_loss = direct.side_loss;
  beam.irradiance = std::move(direct.irradiance);
  return beam;
}

double mean_planck(const OpticalGrid& grid) {
  double sum = 0, weights = 0;
  if (!grid.emits()) return 0;
  grid.for_each_cell([&](int k, std::size_t c, std::uint32_t voxels) {
    const double weight = voxels * static_cast<double>(grid.absorption[c]) * grid.box.thickness_m(k);
    sum += weight * static_cast<double>(grid.planck[c]);
    weights += weight;
  });
  return weights > 0 ? sum / weights : 0;
}

}  // namespace

template <class Real>
TransportSystem<Real> make_system(const Problem& problem, const Discretisation& discretisation,
                                  const SolverOptions& options, std::vector<std::vector<Real>> side_radiance) {
  const BoxGrid& box = problem.grid.box;
  const OrdinateSet& ordinates = discretisation.ordinates;
  const bool independent = options.independent_columns;
  const auto cells = std::make_shared<const Cells<Real>>(
      make_cells<Real>(problem.grid, discretisation.diffuse_fraction(), independent));
  std::vector<double> asymmetry;
  for (const DeltaM& diffuse : discretisation.diffuse) asymmetry.push_back(diffuse.truncated.asymmetry_parameter());
  std::optional<Direction> sun;
  if (problem.sun) sun = problem.sun->travel;
  Ground<Real> ground(problem.surface, ordinates, sun);
  const double incident = incident_power(problem);
  const double power = incident + ground.mean_emission() + matter_emission(problem);
  std::vector<Real> emission;
  for (const Real emitted : cells->emitted) emission.push_back(static_cast<Real>(4 * std::numbers::pi) * emitted);
  const bool thermal = !emission.empty();
  std::vector<OrdinatePath> paths = make_ordinate_paths(box, *cells, ordinates.direction, independent);
  OrdinateScattering<Real> scattering = ordinate_scattering<Real>(discretisation);
  // Light that does not change across columns has slopes along z alone, which differences give as well.
  const VaryingAxes varying = options.linear_source && !independent ? varying_axes(*cells) : VaryingAxes{};
  const bool own_slopes = varying.any();
  Slope<Real> beam_slope;
  SystemBeam<Real> beam =
      system_beam<Real>(problem, discretisation, *cells, options, own_slopes ? &beam_slope : nullptr);
  std::optional<SlopeTables<Real>> slopes;
  if (own_slopes) {
    for (auto& axis : beam_slope) axis.resize(cells->size() + lane_padding);
    if (!varying.x) std::fill(beam_slope[0].begin(), beam_slope[0].end(), Real(0));
    if (!varying.y) std::fill(beam_slope[1].begin(), beam_slope[1].end(), Real(0));
    slopes.emplace(box, *cells, ordinates, paths, scattering.matrix(), std::move(beam_slope), varying);
  }
  return {
      .box = box,
      .independent_columns = independent,
      .cells = cells,
      .ordinates = ordinates,
      .paths = std::move(paths),
      .linear_source = options.linear_source,
      .slopes = std::move(slopes),
      .keeps_radiance_slopes = !options.views.empty() || !options.cameras.empty() || options.circumsolar_half_angle > 0,
      .scattering = std::move(scattering),
      .truncated_asymmetry = std::move(asymmetry),
      .absorption = problem.grid.absorption,
      .beam = std::move(beam),
      .sky_radiance = problem.sky_radiance,
      .ground = std::move(ground),
      .power = power,
      .incident = incident,
      .side_radiance = std::move(side_radiance),
      .emission = std::move(emission),
      .thermal = thermal,
      .planck = problem.grid.planck,
      .mean_planck = mean_planck(problem.grid)};
}

template <class Real>
DirectionalSource<Real> scattered_source(const Discretisation& discretisation, const TransportSystem<Real>& system,
                                         AngularField<Real> radiance) {
  std::vector<DenseMatrix<Real>> to_points;
  for (const auto& table : discretisation.table) to_points.push_back(table.points_from_ordinates.template cast<Real>());
  return {discretisation.points,
          scatter_to<Real>(discretisation.points.size(), std::move(radiance), to_points, *system.cells),
          -Direction::UnitZ(),
          {},
          system.thermal_emission()};
}

template <class Real>
void add_single_scattering(std::vector<SingleScattering<Real>>& first_order, const std::function<double(double)>& phase,
                           std::span<const float> scattering, double share, std::span<const Real> extinction,
                           std::span<const Real> irradiance) {
  SingleScattering<Real> first{phase, std::vector<Real>(irradiance.size(), Real(0))};
  bool any = false;
  for (std::size_t c = 0; c < irradiance.size(); ++c) {
    if (scattering[c] == 0) continue;
    any = true;
    first.intensity[c] = static_cast<Real>(share / (4 * std::numbers::pi) * static_cast<double>(scattering[c]) /
                                           static_cast<double>(extinction[c]) * static_cast<double>(irradiance[c]));
  }
  if (any) first_order.push_back(std::move(first));
}

template <class Real>
void set_first_order(const Problem& problem, const Discretisation& discretisation, const TransportSystem<Real>& system,
                     const DirectBeam<Real>* gather_beam, DirectionalSource<Real>& source) {
  source.first_order.clear();
  if (!problem.sun) return;
  source.sun_travel = problem.sun->travel;
  std::vector<Real> unscattered(system.beam.irradiance.size());
  for (std::size_t c = 0; c < unscattered.size(); ++c)
    unscattered[c] = not_negative(system.beam.irradiance[c] - gather_beam->irradiance[c]);
  for (std::size_t p = 0; p < problem.phase.size(); ++p) {
    const DeltaM& gather = discretisation.gather[p];
    const DeltaM& beam = discretisation.beam[p];
    const auto& scattering = problem.grid.scattering[p];
    add_single_scattering<Real>(source.first_order, gather.truncated, scattering, 1 - gather.forward_fraction,
                                system.cells->extinction, gather_beam->irradiance);
    if (beam.forward_fraction > gather.forward_fraction) {
      add_single_scattering<Real>(source.first_order, beam.truncated, scattering, 1 - beam.forward_fraction,
                                  system.cells->extinction, unscattered);
    }
  }
}

template <class Real>
void set_first_order_beside_peak(const Problem& problem, const Discretisation& discretisation,
                                 const TransportSystem<Real>& system, DirectionalSource<Real>& source) {
  source.first_order.clear();
  if (!problem.sun) return;
  source.sun_travel = problem.sun->travel;
  for (std::size_t p = 0; p < problem.phase.size(); ++p) {
    add_single_scattering<Real>(
        source.first_order, [peak = discretisation.peak[p]](double cos_angle) { return peak.rest(cos_angle); },
        problem.grid.scattering[p], 1., system.cells->extinction, system.beam.irradiance);
  }
}

#define CLOUDBOW_INSTANTIATE(Real)                                                                                     \
  template DirectBeam<Real> beam_with<Real>(const Problem&, const ActiveRows&, const std::vector<double>&,             \
                                            const SolverOptions&, const BeamParts&);                                   \
  template void set_first_order<Real>(const Problem&, const Discretisation&, const TransportSystem<Real>&,             \
                                      const DirectBeam<Real>*, DirectionalSource<Real>&);                              \
  template std::vector<Real> scaled_extinction<Real>(const OpticalGrid&, const std::vector<double>&);                  \
  template void set_first_order_beside_peak<Real>(const Problem&, const Discretisation&, const TransportSystem<Real>&, \
                                                  DirectionalSource<Real>&);                                           \
  template DirectionalSource<Real> scattered_source<Real>(const Discretisation&, const TransportSystem<Real>&,         \
                                                          AngularField<Real>)
CLOUDBOW_INSTANTIATE(float);
CLOUDBOW_INSTANTIATE(double);
#undef CLOUDBOW_INSTANTIATE
template TransportSystem<float> make_system<float>(const Problem&, const Discretisation&, const SolverOptions&,
                                                   std::vector<std::vector<float>>);
template void add_single_scattering<float>(std::vector<SingleScattering<float>>&, const std::function<double(double)>&,
                                           std::span<const float>, double, std::span<const float>,
                                           std::span<const float>);
template TransportSystem<double> make_system<double>(const Problem&, const Discretisation&, const SolverOptions&,
                                                     std::vector<std::vector<double>>);
template void add_single_scattering<double>(std::vector<SingleScattering<double>>&,
                                            const std::function<double(double)>&, std::span<const float>, double,
                                            std::span<const double>, std::span<const double>);

}  // namespace cloudbow
