#include "transport/observers/clear_voxels.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include "cloudbow/core/parallel_errors.hpp"
#include "cloudbow/medium/grid_map.hpp"
#include "transport/gather/source_gradients.hpp"
#include "transport/iteration/source_iteration.hpp"
#include "transport/observers/radiance_march.hpp"

namespace cloudbow {
namespace {

// Ordinates are shared out over so many sums, whatever the number of threads, so that sums have one order.
constexpr std::size_t groups = 4;

// The field's problem with a cell for every voxel up to the clouds, and the field's own cell of each.
template <class Real>
struct SingleVoxels {
  Problem problem;
  Cells<Real> cells;
  std::vector<std::uint32_t> from;  // [n] cell of the field

  SingleVoxels(const ConvergedField<Real>& field, int end)
      : problem{without_air_blocks(field.problem.grid, end), field.problem.phase, field.problem.sun,
                field.problem.sky_radiance, field.problem.surface},
        cells(make_cells<Real>(problem.grid, field.discretisation.diffuse_fraction(), false,
                               std::numeric_limits<std::size_t>::max())),
        from(cells.size(), 0) {
    const BoxGrid& box = field.system.box;
    std::vector<std::uint32_t> cell_at(box.columns() * static_cast<std::size_t>(box.nz()));
    for_each_place(field.system.cells->rows, [&](std::uint32_t cell, std::size_t place) { cell_at[place] = cell; });
    for_each_place(cells.rows, [&](std::uint32_t cell, std::size_t place) { from[cell] = cell_at[place]; });
  }

  void spread(const Real* of_field, std::vector<Real>& to) const {
    to.resize(cells.size() + lane_padding);
    for (std::size_t c = 0; c < from.size(); ++c) to[c] = of_field[from[c]];
  }
};

// One thread's marches.
template <class Real>
struct Marches {
  LinearSource<Real> of_field, of_voxels;
  std::vector<Real> rays, radiance, side, ground;

  // Adds weight times the mean radiance of the voxels along an ordinate.
  void add(const ConvergedField<Real>& field, const SingleVoxels<Real>& voxels, const GatherScene<Real>& scene,
           const GroundRadiance<Real>& lit_ground, const Direction& travel, Real weight, std::vector<Real>& sum) {
    const BoxGrid& box = voxels.problem.grid.box;
    const LevelRange levels{0, box.nz()};
    of_field.resize(field.system.cells->size());
    const CellView<Real> view = cells_along(scene, travel, of_field);
    scene.source->query(travel, of_field.value.data());
    voxels.spread(of_field.value.data(), of_voxels.value);
    for (std::size_t axis = 0; axis < 3 && view.is_linear(); ++axis)
      voxels.spread(view.gradient[axis], of_voxels.gradient[axis]);
    const StartFraction start = start_for_centred_exit(box, travel, false, levels);
    const PathPattern pattern = make_path_pattern(box, travel, start.x, start.y, false, levels);
    rays.assign(box.columns() + lane_padding, static_cast<Real>(voxels.problem.sky_radiance));
    if (pattern.upward) std::copy_n(lit_ground.along(travel, ground), box.columns(), rays.begin());
    side.clear();
    if (field.lateral_boundary != nullptr) {
      const auto by_height = field.lateral_boundary->radiance(travel);
      side.assign(by_height.begin(), by_height.end());
      if (!pattern.upward) std::reverse(side.begin(), side.end());
    }
    radiance.assign(voxels.cells.size() + lane_padding, Real(0));
    march<Real, true>(pattern, voxels.cells.rows, of_voxels.view(voxels.cells), box.periodic,
                      std::span<const Real>(side), of_voxels.value.data(), rays.data(), {radiance.data(), {}},
                      [](int, const Real*) {});
    for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += weight * radiance[c];
  }
};

template <class Real>
std::vector<double> actinic_flux(const ConvergedField<Real>& field, const SingleVoxels<Real>& voxels,
                                 DirectionalSource<Real>& source) {
  const Problem& problem = field.problem;
  // Beam and diffuse light are those of the iteration.
  std::optional<DirectBeam<Real>> beam;
  source.first_order.clear();
  if (problem.sun) {
    source.sun_travel = problem.sun->travel;
    beam = beam_with<Real>(voxels.problem, voxels.cells.rows, field.discretisation.beam_fraction(), field.options);
    for (std::size_t p = 0; p < problem.phase.size(); ++p) {
      const DeltaM& of_beam = field.discretisation.beam[p];
      add_single_scattering<Real>(source.first_order, of_beam.truncated, problem.grid.scattering[p],
                                  1 - of_beam.forward_fraction, field.system.cells->extinction,
                                  field.system.beam.irradiance);
    }
  }
  const GatherScene<Real> scene{.box = field.system.box,
                                .cells = *field.system.cells,
                                .source = &source,
                                .linear_source = field.system.linear_source,
                                .beam_slope = field.system.slopes ? &field.system.slopes->beam() : nullptr,
                                .slopes = field.result.slopes ? &*field.result.slopes : nullptr};
  const GroundRadiance<Real> ground = ground_of_iteration(field.system, field.result.fluxes);
  const OrdinateSet& ordinates = field.system.ordinates;
  std::vector<std::vector<Real>> sums(groups);
  ParallelErrors errors;
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t g = 0; g < groups; ++g) {
    errors.run([&] {
      Marches<Real> marches;
      sums[g].assign(voxels.cells.size(), Real(0));
      for (std::size_t d = g; d < static_cast<std::size_t>(ordinates.size()); d += groups) {
        marches.add(field, voxels, scene, ground, ordinates.direction[d], static_cast<Real>(ordinates.weight[d]),
                    sums[g]);
      }
    });
  }
  errors.rethrow();
  std::vector<double> flux(voxels.cells.size(), 0.);
  for (std::size_t c = 0; c < flux.size(); ++c) {
    if (beam) flux[c] = static_cast<double>(beam->irradiance[c]);
    for (const std::vector<Real>& sum : sums) flux[c] += static_cast<double>(sum[c]);
  }
  return flux;
}

}  // namespace

template <class Real>
std::vector<float> light_within_blocks(const ConvergedField<Real>& field, DirectionalSource<Real>& source) {
  const ActiveRows& rows = field.system.cells->rows;
  int end = rows.nz;
  while (end > 0 && !rows.has_voxels(end - 1)) --end;
  const SingleVoxels<Real> voxels(field, end);
  const std::vector<double> flux = actinic_flux(field, voxels, source);
  std::vector<double> mean(rows.size(), 0.);
  for_each_place(voxels.cells.rows, [&](std::uint32_t c, std::size_t) {
    mean[voxels.from[c]] += flux[c] / rows.places_of(voxels.from[c]);
  });
  std::vector<float> relative(field.system.box.columns() * static_cast<std::size_t>(end), 1.F);
  for_each_place(voxels.cells.rows, [&](std::uint32_t c, std::size_t place) {
    const double of_block = mean[voxels.from[c]];
    if (place < relative.size() && rows.places_of(voxels.from[c]) > 1 && of_block > 0)
      relative[place] = static_cast<float>(flux[c] / of_block);
  });
  return relative;
}

template std::vector<float> light_within_blocks<float>(const ConvergedField<float>&, DirectionalSource<float>&);
template std::vector<float> light_within_blocks<double>(const ConvergedField<double>&, DirectionalSource<double>&);

}  // namespace cloudbow
