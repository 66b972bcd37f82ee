#include "transport/observers/cell_fields.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

#include "cloudbow/core/parallel_errors.hpp"
#include "transport/iteration/source_iteration.hpp"
#include "transport/observers/clear_voxels.hpp"
#include "transport/observers/radiance_march.hpp"

namespace cloudbow {

namespace {

// Whether any block of air absorbs, from the ground to the highest level with a cloud. The light then is computed voxel
// by voxel.
template <class Real>
bool absorbs_in_blocks(const TransportSystem<Real>& system) {
  const ActiveRows& rows = system.cells->rows;
  bool below_voxels = false, absorbs = false;
  for (int k = rows.nz - 1; k >= 0 && rows.has_air(); --k) {
    below_voxels = below_voxels || rows.has_voxels(k);
    for (std::uint32_t c = rows.voxels_end(k); below_voxels && c < rows.level_cell[k + 1]; ++c)
      absorbs = absorbs || system.absorption[c] > 0;
  }
  return absorbs;
}

}  // namespace

template <class Real>
bool needs_light_within_blocks(const TransportSystem<Real>& system, const SolverOptions& options) {
  return options.absorption && absorbs_in_blocks(system);
}

template <class Real>
void fill_cell_fields(const ConvergedField<Real>& field, DirectionalSource<Real>* source,
                      std::span<const Real> scalar_flux, Solution& solution) {
  const Problem& problem = field.problem;
  const SolverOptions& options = field.options;
  const TransportSystem<Real>& system = field.system;
  const std::size_t cells = system.box.columns() * static_cast<std::size_t>(system.box.nz());
  if (options.absorption) solution.absorbed_power.assign(cells, 0.F);
  if (options.actinic) solution.actinic_flux.assign(cells, std::numeric_limits<float>::quiet_NaN());
  std::vector<float> within_blocks;
  if (source != nullptr && needs_light_within_blocks(system, options))
    within_blocks = light_within_blocks(field, *source);
  for_each_place(system.cells->rows, [&](std::uint32_t c, std::size_t place) {
    double actinic =
        static_cast<double>(scalar_flux[c]) + (problem.sun ? static_cast<double>(system.beam.irradiance[c]) : 0.);
    if (place < within_blocks.size()) actinic *= static_cast<double>(within_blocks[place]);
    const double emitted = system.planck.empty() ? 0. : 4 * std::numbers::pi * static_cast<double>(system.planck[c]);
    if (options.absorption)
      solution.absorbed_power[place] =
          static_cast<float>(static_cast<double>(system.absorption[c]) * (actinic - emitted));
    if (options.actinic) solution.actinic_flux[place] = static_cast<float>(actinic);
  });
}

template <class Real>
RadianceField make_radiance_field(const ConvergedField<Real>& converged, DirectionalSource<Real>& source) {
  const Problem& problem = converged.problem;
  const Discretisation& discretisation = converged.discretisation;
  const SolverOptions& options = converged.options;
  const TransportSystem<Real>& system = converged.system;
  const IterationResult<Real>& solved = converged.result;
  const LateralBoundary* const lateral_boundary = converged.lateral_boundary;
  std::optional<DirectBeam<Real>> beam;
  if (problem.sun)
    beam = beam_with<Real>(problem, system.cells->rows, discretisation.gather_fraction(), options, of_cells);
  set_first_order(problem, discretisation, system, beam ? &*beam : nullptr, source);
  const ControlPoints points(options.control_points, control_point_frame_rotation());
  RadianceField field;
  field.direction.assign(points.directions().begin(), points.directions().end());
  field.triangle.assign(points.triangles().begin(), points.triangles().end());
  const std::size_t n = system.cells->size();
  const std::size_t m = field.direction.size();
  const std::size_t columns = system.box.columns();
  for (const std::uint32_t c : dense_indices(system.cells->rows)) {
    field.voxel.push_back({static_cast<std::int32_t>(c % system.box.nx),
                           static_cast<std::int32_t>(c / system.box.nx % system.box.ny),
                           static_cast<std::int32_t>(c / columns)});
  }
  field.radiance.resize(n * m);
  const GroundRadiance<Real> ground = ground_of_iteration(system, solved.fluxes);
  ParallelErrors errors;
#pragma omp parallel
  {
    RadianceMarch<Real> along;
#pragma omp for schedule(dynamic, 1)
    for (std::size_t d = 0; d < m; ++d) {
      errors.run([&] {
        const Direction& travel = field.direction[d];
        std::vector<Real> sent(n);
        source.query(travel, sent.data());
        const std::span<const Real> radiance =
            along.mean_radiance(problem, system, ground, lateral_boundary, travel, sent);
        for (std::size_t c = 0; c < n; ++c) field.radiance[c * m + d] = static_cast<float>(radiance[c]);
      });
    }
  }
  errors.rethrow();
  return field;
}

#define CLOUDBOW_INSTANTIATE(Real)                                                                                   \
  template bool needs_light_within_blocks<Real>(const TransportSystem<Real>&, const SolverOptions&);                 \
  template void fill_cell_fields<Real>(const ConvergedField<Real>&, DirectionalSource<Real>*, std::span<const Real>, \
                                       Solution&);                                                                   \
  template RadianceField make_radiance_field<Real>(const ConvergedField<Real>&, DirectionalSource<Real>&)
CLOUDBOW_INSTANTIATE(float);
CLOUDBOW_INSTANTIATE(double);
#undef CLOUDBOW_INSTANTIATE

}  // namespace cloudbow
