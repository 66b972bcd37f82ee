#include "transport/observers/clear_voxels.hpp"

#include <algorithm>
#include <optional>
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

// Rays of one segment cross blocks of air. Their mean radiance counts for the single voxels.
template <bool linear, class Real>
class VoxelsOfAir {
 public:
  // @param rays of the direction; @param weight of it; @param sum [columns] of the level's voxels; null: not kept.
  VoxelsOfAir(const Segment& segment, double chord, Real extinction, const CellView<Real>& cells, const Real* source,
              Real* rays, const BoxGrid& box, Real weight, Real* sum)
      : g_(segment, chord),
        crossing_(optical_path(extinction, g_.length)),
        cells_(cells),
        source_(source),
        rays_(rays),
        nx_(box.nx),
        ny_(box.ny),
        ox_(wrapped(segment.shift_x, box.nx)),
        oy_(wrapped(segment.shift_y, box.ny)),
        weight_(weight),
        sum_(sum) {}

  void enter(std::size_t cell) {
    Real entry = source_[cell], exit = entry;
    if constexpr (linear) {
      const Real x = cells_.gradient[0][cell], y = cells_.gradient[1][cell], z = cells_.gradient[2][cell];
      entry *= g_.at_entry(x, y, z);
      exit *= g_.at_exit(x, y, z);
    }
    emission_ = crossing_.t * crossing_.emitted(entry, exit);
    held_ = crossing_.mean(Real(0), entry, exit);
  }
  void cross(std::size_t ray, int n) const {
    while (n > 0) {
      const int m = static_cast<int>(ray % nx_), column = wrapped(m + ox_, nx_);
      const int run = std::min({n, nx_ - m, nx_ - column});
      const auto row = static_cast<std::size_t>(wrapped(static_cast<int>(ray / nx_) + oy_, ny_));
      cross_row(rays_ + ray, run, sum_ == nullptr ? nullptr : sum_ + row * nx_ + column);
      ray += static_cast<std::size_t>(run);
      n -= run;
    }
  }
  void leave() const {}

 private:
  void cross_row(Real* __restrict rays, int n, Real* __restrict sum) const {
    const Real absorbed = crossing_.absorbed(), emission = emission_;
    if (sum != nullptr) {
      const Real share = weight_ * g_.share, passing = share * crossing_.phi.phi1, own = share * held_;
#pragma omp simd
      for (int i = 0; i < n; ++i) sum[i] += passing * rays[i] + own;
    }
#pragma omp simd
    for (int i = 0; i < n; ++i) rays[i] += emission - absorbed * rays[i];
  }

  SegmentGeometry<Real> g_;
  Crossing<Real> crossing_;
  CellView<Real> cells_;
  const Real* source_;
  Real* rays_;
  int nx_, ny_;
  int ox_, oy_;
  Real weight_;
  Real* sum_;
  Real emission_ = 0;
  Real held_ = 0;  // mean radiance in a segment that no light enters
};

// One thread's marches.
template <class Real>
class VoxelMarch {
 public:
  // @param end only voxels of the levels below it are looked at.
  VoxelMarch(const ConvergedField<Real>& field, const GatherScene<Real>& scene, const GroundRadiance<Real>& ground,
             int end)
      : field_(field), scene_(scene), ground_(ground), end_(end), box_(field.system.box) {
    // Single voxels of a uniform level are crossed one by one.
    std::fill_n(box_.uniform.begin(), std::min<std::size_t>(box_.uniform.size(), end), std::uint8_t{0});
  }

  // Adds weight times the mean radiance of voxels of the air along an ordinate. @param sum [end][columns]
  void add(const Direction& travel, Real weight, std::vector<Real>& sum) {
    const BoxGrid& box = box_;
    const ActiveRows& rows = field_.system.cells->rows;
    const LevelRange levels{0, box.nz()};
    own_.resize(field_.system.cells->size());
    const CellView<Real> cells = cells_along(scene_, travel, own_);
    scene_.source->query(travel, own_.value.data());
    const Real* const source = own_.value.data();
    const MarchedCells<Real> marched{0, cells, source};
    const StartFraction start = start_for_centred_exit(box, travel, false, levels);
    const PathPattern pattern = make_path_pattern(box, travel, start.x, start.y, false, levels);
    rays_.assign(box.columns() + lane_padding, static_cast<Real>(field_.problem.sky_radiance));
    if (pattern.upward) std::copy_n(ground_.along(travel, from_ground_), box.columns(), rays_.begin());
    std::vector<double> side;
    if (field_.lateral_boundary != nullptr) side = field_.lateral_boundary->radiance(travel);
    MarchedRays<Real> all(rays_.data(), rows);
    for (int step = 0; step < pattern.levels(); ++step) {
      const int level = pattern.level(step);
      if (box.periodic && level >= end_ && rows.is_uniform(level)) {
        for_source_of(cells, [&](auto linear) {
          cross_uniform_level<CrossingKind<false, false, linear>>(pattern, step, rows, marched, all);
        });
        continue;
      }
      all.write();
      const double chord = pattern.chord_m[step];
      Real* const of_level = level < end_ ? sum.data() + static_cast<std::size_t>(level) * box.columns() : nullptr;
      const auto enter = [&](const Segment& segment, double at) {
        if (box.periodic) return;
        const int before = pattern.upward ? level : level + 1, after = pattern.upward ? level + 1 : level;
        const Real outside = side.empty() ? Real(0) : static_cast<Real>((1 - at) * side[before] + at * side[after]);
        for_rays_through_side(segment, box.nx, box.ny, [&](std::size_t ray) { rays_[ray] = outside; });
      };
      for_source_of(cells, [&](auto linear) {
        using Kind = CrossingKind<false, false, linear>;
        const auto begin = [&](const Segment& segment) {
          return [&, g = SegmentGeometry<Real>(segment, chord)](std::size_t ray, std::size_t cell, int count) {
            cross_cells<Kind>(g, count, marched, cell, rays_.data() + ray, PlainRays());
          };
        };
        const auto begin_air = [&](const Segment& segment) {
          return VoxelsOfAir<linear, Real>(segment, chord, cells.extinction[rows.air[level].first_cell], cells, source,
                                           rays_.data(), box, weight, of_level);
        };
        cross_level(pattern, step, level, rows, begin, begin_air, enter);
      });
    }
  }

 private:
  const ConvergedField<Real>& field_;
  const GatherScene<Real>& scene_;
  const GroundRadiance<Real>& ground_;
  int end_;
  BoxGrid box_;
  LinearSource<Real> own_;
  std::vector<Real> rays_, from_ground_;
};

// Irradiance by the iteration's beam on a surface that faces the sun, [end][columns].
template <class Real>
std::vector<double> beam_irradiance(const ConvergedField<Real>& field, int end) {
  const Problem& of_field = field.problem;
  const Problem problem{without_air_blocks(of_field.grid, end), of_field.phase, of_field.sun, of_field.sky_radiance,
                        of_field.surface};
  const ActiveRows rows = active_rows(problem.grid);
  const DirectBeam<Real> beam =
      beam_with<Real>(problem, rows, field.discretisation.beam_fraction(), field.options, of_cells);
  std::vector<double> irradiance(problem.grid.box.columns() * static_cast<std::size_t>(end), 0.);
  for_each_place(rows, [&](std::uint32_t cell, std::size_t place) {
    if (place < irradiance.size()) irradiance[place] = static_cast<double>(beam.irradiance[cell]);
  });
  return irradiance;
}

// Actinic flux of the voxels of blocks, [end][columns]. Voxels with their own cell have the irradiance of the beam
// alone.
template <class Real>
std::vector<double> actinic_flux(const ConvergedField<Real>& field, DirectionalSource<Real>& source, int end) {
  const Problem& problem = field.problem;
  const std::size_t places = field.system.box.columns() * static_cast<std::size_t>(end);
  // Beam and diffuse light are those of the iteration.
  source.first_order.clear();
  if (problem.sun) {
    source.sun_travel = problem.sun->travel;
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
      VoxelMarch<Real> march(field, scene, ground, end);
      sums[g].assign(places, Real(0));
      for (std::size_t d = g; d < static_cast<std::size_t>(ordinates.size()); d += groups)
        march.add(ordinates.direction[d], static_cast<Real>(ordinates.weight[d]), sums[g]);
    });
  }
  errors.rethrow();
  std::vector<double> flux = problem.sun ? beam_irradiance(field, end) : std::vector<double>(places, 0.);
  for (const std::vector<Real>& sum : sums) {
    for (std::size_t c = 0; c < places; ++c) flux[c] += static_cast<double>(sum[c]);
  }
  return flux;
}

}  // namespace

template <class Real>
std::vector<float> light_within_blocks(const ConvergedField<Real>& field, DirectionalSource<Real>& source) {
  const ActiveRows& rows = field.system.cells->rows;
  int end = rows.nz;
  while (end > 0 && !rows.has_voxels(end - 1)) --end;
  const std::vector<double> flux = actinic_flux(field, source, end);
  std::vector<double> mean(rows.size(), 0.);
  const auto for_each_voxel_of_air = [&](const auto& use) {
    for_each_place(rows, [&](std::uint32_t cell, std::size_t place) {
      if (place < flux.size() && rows.places_of(cell) > 1) use(cell, place);
    });
  };
  for_each_voxel_of_air(
      [&](std::uint32_t cell, std::size_t place) { mean[cell] += flux[place] / rows.places_of(cell); });
  std::vector<float> relative(flux.size(), 1.F);
  for_each_voxel_of_air([&](std::uint32_t cell, std::size_t place) {
    if (mean[cell] > 0) relative[place] = static_cast<float>(flux[place] / mean[cell]);
  });
  return relative;
}

template std::vector<float> light_within_blocks<float>(const ConvergedField<float>&, DirectionalSource<float>&);
template std::vector<float> light_within_blocks<double>(const ConvergedField<double>&, DirectionalSource<double>&);

}  // namespace cloudbow
