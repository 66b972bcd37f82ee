#include "transport/system/transport_system.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "cloudbow/core/not_negative.hpp"

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
void TransportSystem<Real>::fold_scattering() {
  low = LowMoments<Real>(ordinates);
  octant_scattering = OctantScattering<Real>::make(ordinates, scattering, low.weights, low.shape);
}

template <class Real>
void TransportSystem<Real>::scatter(AngularField<Real>& field, std::span<const Real> correction, bool dark) const {
  const ScatteringTerms<Real> terms{beam, correction, emission, dark};
  if (octant_scattering) {
    octant_scattering->scatter_in_place(field, *cells, terms);
  } else {
    scatter_in_place<Real>(field, scattering, *cells, terms, low.shape);
  }
}

template <class Real>
void TransportSystem<Real>::moments(const AngularField<Real>& radiance, std::span<Real> of) const {
  if (octant_scattering) {
    octant_scattering->moments_of(radiance, of);
  } else {
    moments_of<Real>(radiance, low.weights, of);
  }
}

template <class Real>
DirectBeam<Real> beam_with(const Problem& problem, const ActiveRows& rows, const std::vector<double>& forward_fraction,
                           const SolverOptions& options, bool irradiance) {
  const std::vector<Real> extinction = scaled_extinction<Real>(problem.grid, forward_fraction);
  return direct_beam<Real>(problem.grid.box, rows, extinction, scaled_layer_extinction(problem.grid, forward_fraction),
                           *problem.sun, {options.beam_rays, options.independent_columns, irradiance});
}

template <class Real>
TransportSystem<Real> make_system(const Problem& problem, const Discretisation& discretisation,
                                  const SolverOptions& options) {
  TransportSystem<Real> system;
  system.box = problem.grid.box;
  system.independent_columns = options.independent_columns;
  system.linear_source = options.linear_source;
  system.cells = std::make_shared<const Cells<Real>>(
      make_cells<Real>(problem.grid, discretisation.diffuse_fraction(), system.independent_columns));
  system.ordinates = discretisation.ordinates;
  system.paths = make_ordinate_paths(system.box, *system.cells, system.ordinates.direction, system.independent_columns);
  for (std::size_t p = 0; p < discretisation.table.size(); ++p) {
    system.scattering.push_back(
        rounded_conservatively<Real>(discretisation.table[p].ordinates_from_ordinates, system.ordinates.weight));
    system.truncated_asymmetry.push_back(discretisation.diffuse[p].truncated.asymmetry_parameter());
  }
  system.fold_scattering();
  system.absorption.assign(problem.grid.absorption.begin(), problem.grid.absorption.end());
  system.sky_radiance = problem.sky_radiance;
  system.ground = Ground<Real>(problem.surface, system.ordinates,
                               problem.sun ? std::optional<Direction>(problem.sun->travel) : std::nullopt);
  system.power_in = std::numbers::pi * problem.sky_radiance;
  if (problem.sun) {
    system.power_in += -problem.sun->travel.z() * problem.sun->irradiance;
    const std::vector<double> fraction = discretisation.beam_fraction();
    DirectBeam<Real> beam = beam_with<Real>(problem, system.cells->rows, fraction, options);
    for (std::size_t p = 0; p < discretisation.table.size(); ++p) {
      BeamSource<Real> source;
      source.direction = discretisation.table[p].ordinates_from_beam.template cast<Real>();
      source.intensity.resize(system.cells->size());
      bool any = false;
      for (std::size_t c = 0; c < source.intensity.size(); ++c) {
        const double scattered = (1 - fraction[p]) * problem.grid.scattering[p][c];
        any = any || scattered > 0;
        source.intensity[c] = scattered > 0 ? static_cast<Real>(scattered * static_cast<double>(beam.irradiance[c]) /
                                                                static_cast<double>(system.cells->extinction[c]))
                                            : Real(0);
      }
      if (any) system.beam.push_back(std::move(source));
    }
    for (auto level = beam.level_flux.begin(); level != beam.level_flux.end();
         level += static_cast<std::ptrdiff_t>(system.box.columns())) {
      const double sum = std::accumulate(level, level + static_cast<std::ptrdiff_t>(system.box.columns()), 0.);
      system.beam_profile.push_back(sum / static_cast<double>(system.box.columns()));
    }
    system.beam_surface_flux.assign(beam.level_flux.begin(),
                                    beam.level_flux.begin() + static_cast<std::ptrdiff_t>(system.box.columns()));
    system.beam_side_gain = beam.side_gain;
    system.beam_side_loss = beam.side_loss;
    system.beam_irradiance = std::move(beam.irradiance);
  }
  return system;
}

template <class Real>
DirectionalSource<Real> scattered_source(const Discretisation& discretisation, const TransportSystem<Real>& system,
                                         AngularField<Real> radiance) {
  std::vector<DenseMatrix<Real>> to_points;
  for (const auto& table : discretisation.table) to_points.push_back(table.points_from_ordinates.template cast<Real>());
  return {discretisation.points,
          scatter_to<Real>(discretisation.points.size(), std::move(radiance), to_points, *system.cells),
          -Direction::UnitZ(),
          {}};
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
  std::vector<Real> unscattered(system.beam_irradiance.size());
  for (std::size_t c = 0; c < unscattered.size(); ++c)
    unscattered[c] = not_negative(system.beam_irradiance[c] - gather_beam->irradiance[c]);
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
        problem.grid.scattering[p], 1., system.cells->extinction, system.beam_irradiance);
  }
}

template struct TransportSystem<float>;
template struct TransportSystem<double>;
#define CLOUDBOW_INSTANTIATE(Real)                                                                                     \
  template DirectBeam<Real> beam_with<Real>(const Problem&, const ActiveRows&, const std::vector<double>&,             \
                                            const SolverOptions&, bool);                                               \
  template TransportSystem<Real> make_system<Real>(const Problem&, const Discretisation&, const SolverOptions&);       \
  template void set_first_order<Real>(const Problem&, const Discretisation&, const TransportSystem<Real>&,             \
                                      const DirectBeam<Real>*, DirectionalSource<Real>&);                              \
  template std::vector<Real> scaled_extinction<Real>(const OpticalGrid&, const std::vector<double>&);                  \
  template void set_first_order_beside_peak<Real>(const Problem&, const Discretisation&, const TransportSystem<Real>&, \
                                                  DirectionalSource<Real>&);                                           \
  template DirectionalSource<Real> scattered_source<Real>(const Discretisation&, const TransportSystem<Real>&,         \
                                                          AngularField<Real>);                                         \
  template void add_single_scattering<Real>(std::vector<SingleScattering<Real>>&,                                      \
                                            const std::function<double(double)>&, std::span<const float>, double,      \
                                            std::span<const Real>, std::span<const Real>)
CLOUDBOW_INSTANTIATE(float);
CLOUDBOW_INSTANTIATE(double);
#undef CLOUDBOW_INSTANTIATE

}  // namespace cloudbow
