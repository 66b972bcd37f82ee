#include "transport/system/sweep.hpp"

#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "cloudbow/core/parallel_errors.hpp"
#include "transport/system/arriving_sum.hpp"
#include "transport/system/ordinate_march.hpp"

namespace cloudbow {
namespace {

constexpr std::size_t block_cells = 4096;  // a thread's share of loops over cells

// Whether the ordinates of an octant share the gradient of their mean source; else each has its own, or there is none.
template <class Real>
bool shares_gradients(const TransportSystem<Real>& system) {
  return system.linear_source && system.cells->heterogeneous;
}

// Ordinates that are marched side by side: an octant's if they share slopes or a gradient, else all.
template <class Real>
std::vector<std::vector<int>> groups_side_by_side(const TransportSystem<Real>& system, bool by_octant, bool upward) {
  std::vector<std::vector<int>> groups;
  std::array<int, 4> of_quadrant{-1, -1, -1, -1};
  for (int d = 0; d < system.ordinates.size(); ++d) {
    const Direction& o = system.ordinates.direction[d];
    if ((o.z() > 0) != upward) continue;
    int& group = of_quadrant[by_octant ? (o.x() > 0 ? 1 : 0) + (o.y() > 0 ? 2 : 0) : 0];
    if (group < 0) {
      group = static_cast<int>(groups.size());
      groups.emplace_back();
    }
    groups[group].push_back(d);
  }
  return groups;
}

// Gradient of the mean source of some ordinates. Called by all threads of a team.
template <class Real>
void team_make_gradient(const TransportSystem<Real>& system, const AngularField<Real>& field,
                        const std::vector<int>& group, bool transposed, GroupGradient<Real>& gradient,
                        ParallelErrors& errors) {
  const Cells<Real>& cells = *system.cells;
  const std::size_t n = cells.size();
#pragma omp single
  errors.run([&] {
    gradient.source.resize(n);
    gradient.rest.resize(system.thermal ? n : 0);
    for (auto& axis : gradient.axis) axis.resize(n + lane_padding);
    for (auto& axis : gradient.transposed) axis.resize(transposed ? n + lane_padding : 0);
  });
  const CellEmission<Real> emission = system.thermal_emission();
  double weights = 0;
  for (const int d : group) weights += system.ordinates.weight[d];
  const std::size_t blocks = (n + block_cells - 1) / block_cells;
#pragma omp for schedule(static)
  for (std::size_t block = 0; block < blocks; ++block) {
    errors.run([&] {
      const std::size_t first = block * block_cells;
      const std::size_t count = std::min(block_cells, n - first);
      Real* __restrict const to = gradient.source.data() + first;
      std::fill_n(to, count, Real(0));
      std::array<Real, block_cells> room{};
      for (const int d : group) {
        const Real weight = static_cast<Real>(system.ordinates.weight[d]);
        const Real* __restrict const from = field.stored_row(d).read(first, count, room.data());
        for (std::size_t c = 0; c < count; ++c) to[c] += weight * from[c];
      }
      if (!system.thermal) return;
      // The mean source rather than its sum, as emission is given.
      const Real mean = static_cast<Real>(1 / weights);
      for (std::size_t c = 0; c < count; ++c) {
        to[c] *= mean;
        gradient.rest[first + c] = to[c] - emission.source[first + c];
      }
    });
  }
#pragma omp for schedule(static)
  for (std::size_t block = 0; block < blocks; ++block) {
    errors.run([&] {
      const std::size_t first = block * block_cells;
      const std::size_t count = std::min(block_cells, n - first);
      Real* const x = gradient.axis[0].data() + first;
      Real* const y = gradient.axis[1].data() + first;
      Real* const z = gradient.axis[2].data() + first;
      if (system.thermal) {
        source_gradient(cells, emission, first, count, gradient.source.data(), gradient.rest.data(), x, y, z);
      } else {
        source_gradient(cells, first, count, gradient.source.data(), x, y, z);
      }
    });
  }
  if (!transposed) return;
#pragma omp for schedule(static)
  for (std::size_t block = 0; block < blocks; ++block) {
    errors.run([&] {
      const std::size_t last = std::min(n, (block + 1) * block_cells);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const Real* __restrict const from = gradient.axis[axis].data();
        Real* __restrict const to = gradient.transposed[axis].data();
        const std::uint32_t* __restrict const cell = cells.transposed[0].cell.data();
        for (std::size_t c = block * block_cells; c < last; ++c) to[c] = from[cell[c]];
      }
    });
  }
}

// The light that arrives at the ground along the ordinates of all ranks.
template <class Real>
void gather_arriving(const OrdinateShare& share, const OrdinateSet& ordinates, std::size_t columns,
                     std::vector<ArrivingRays<Real>>& arriving) {
  std::vector<std::span<Real>> radiance(arriving.size());
  std::vector<std::array<int, 2>> shift(arriving.size());
  std::vector<std::span<int>> shifts(arriving.size());
  for (std::size_t d = 0; d < arriving.size(); ++d) {
    if (ordinates.direction[d].z() > 0) continue;
    arriving[d].radiance.resize(columns + lane_padding);
    radiance[d] = std::span(arriving[d].radiance).first(columns);
    shift[d] = {arriving[d].shift_x, arriving[d].shift_y};
    shifts[d] = shift[d];
  }
  share.gather_ordinates<Real>(radiance);
  share.gather_ordinates<int>(shifts);
  for (std::size_t d = 0; d < arriving.size(); ++d) {
    if (shifts[d].empty()) continue;
    arriving[d].shift_x = shift[d][0];
    arriving[d].shift_y = shift[d][1];
  }
}

// @param flux [octants / 2][columns] of add_arriving().
void gather_arriving_flux(const OrdinateShare& share, std::size_t columns, std::vector<double>& flux) {
  std::vector<std::span<double>> of_octant;
  for (std::size_t octant = 0; octant < flux.size() / columns; ++octant)
    of_octant.push_back(std::span(flux).subspan(octant * columns, columns));
  share.gather_octants<double>(of_octant);
}

void gather_fluxes(const OrdinateShare& share, std::vector<OrdinateFluxes>& of_ordinate, std::size_t levels) {
  std::vector<double> numbers;
  for (OrdinateFluxes& fluxes : of_ordinate) {
    fluxes.profile.resize(levels);
    numbers.insert(numbers.end(), {fluxes.out, fluxes.sides.entered_sides, fluxes.sides.left_sides});
    numbers.insert(numbers.end(), fluxes.profile.begin(), fluxes.profile.end());
  }
  const std::size_t each = 3 + levels;
  std::vector<std::span<double>> spans;
  for (std::size_t d = 0; d < of_ordinate.size(); ++d) spans.push_back(std::span(numbers).subspan(d * each, each));
  share.gather_ordinates<double>(spans);
  for (std::size_t d = 0; d < of_ordinate.size(); ++d) {
    OrdinateFluxes& fluxes = of_ordinate[d];
    fluxes.out = spans[d][0];
    fluxes.sides.entered_sides = spans[d][1];
    fluxes.sides.left_sides = spans[d][2];
    std::copy(spans[d].begin() + 3, spans[d].end(), fluxes.profile.begin());
  }
}

}  // namespace

template <class Real>
void finish_slopes(const TransportSystem<Real>& system, const OrdinateShare& share, const AngularField<Real>& radiance,
                   LightSlopes<Real>& slopes) {
  share.octants_to_cells(slopes.of_radiance);
  for (Slope<Real>& octant : slopes.of_octant) {
    for (std::vector<Real>& axis : octant) axis = std::vector<Real>(radiance.cells + lane_padding);
  }
  system.slopes->scatter(*system.cells, radiance, slopes);
  share.octants_to_rows(slopes.of_octant);
  slopes.fitted = true;
}

template <class Real>
SweepFluxes<Real> sweep(const TransportSystem<Real>& system, AngularField<Real>& field, bool record,
                        SweepWorkspace<Real>& work, LightSlopes<Real>* slopes, const OrdinateShare* share) {
  const BoxGrid& box = system.box;
  const OrdinateSet& ordinates = system.ordinates;
  const std::size_t columns = box.columns();
  const int levels = box.nz() + 1;
  const bool keep_columns = record && system.has_independent_columns();
  std::vector<OrdinateFluxes> of_ordinate(ordinates.size());
  std::vector<ArrivingRays<Real>>& arriving = work.arriving;
  arriving.resize(ordinates.size());
  std::vector<std::vector<Real>> passing(keep_columns ? ordinates.size() : 0);  // [levels * columns] by height
  typename Ground<Real>::Reflection ground;
  work.of_thread.resize(omp_get_max_threads());
  const std::size_t n = system.cells->size();
  const bool mixed = slopes != nullptr && slopes->fitted;
  const bool new_slopes = slopes != nullptr && !slopes->frozen;
  if (new_slopes && share != nullptr) slopes->of_radiance = {};
  if (new_slopes) {
    for (auto& axis : work.moment) axis.resize(n + lane_padding);
  }
  if (mixed) work.gradient = {};
  const bool adds_at_once = system.ground.is_lambertian();
  std::vector<double> arriving_flux(octants / 2 * columns, 0.);
  ArrivingSum<Real> arriving_sum(ordinates, box, arriving_flux);

  const auto march_ordinates = [&](bool upward) {
    const bool shared = !mixed && shares_gradients(system);
    auto groups = groups_side_by_side(system, slopes != nullptr || shared, upward);
    if (share != nullptr) {
      for (std::vector<int>& group : groups) std::erase_if(group, [share](int d) { return !share->has(d); });
      std::erase_if(groups, [](const std::vector<int>& group) { return group.empty(); });
    }
    ParallelErrors errors;
#pragma omp parallel
    {
      typename SweepWorkspace<Real>::Thread& own = work.of_thread[omp_get_thread_num()];
      OrdinateMarch<Real> march(system, mixed ? slopes : nullptr, own);
      for (const std::vector<int>& group : groups) {
        const bool transposed =
            std::any_of(group.begin(), group.end(), [&](int d) { return system.paths[d].goes_along_x(); });
#pragma omp single
        arriving_sum.start(group);
        if (shared) team_make_gradient(system, field, group, transposed, work.gradient, errors);
        const auto march_one = [&](std::size_t q) {
          errors.run([&] {
            const int d = group[q];
            ArrivingRays<Real>& landing = upward || adds_at_once ? own.rays : arriving[d];
            std::vector<Real>& rays = landing.radiance;
            if (upward) {
              const Real* const start_of_rays = ground.leaving.row(system.ground.leaving_row(d));
              rays.assign(start_of_rays, start_of_rays + columns);
              rays.resize(columns + lane_padding);
            } else {
              rays.assign(columns + lane_padding, static_cast<Real>(system.sky_radiance));
            }
            if (keep_columns) passing[d].resize(columns * levels);
            if (field.packed()) {
              own.unpacked.resize(n + lane_padding);
              field.stored_row(d).read(0, n, own.unpacked.data());
            }
            std::vector<Real>& source = field.packed() ? own.unpacked : field.data[d];
            if (mixed && !system.paths[d].sideways.empty()) {
              mix_slopes_of_ordinate(system, *slopes, d, source.data(), own);
            } else if (!mixed && system.linear_source && !shared) {
              gradient_of_ordinate(system, source.data(), own);
            }
            march.cross_box(d, shared ? work.gradient : own.gradient, source, landing, record, new_slopes,
                            keep_columns ? passing[d].data() : nullptr, of_ordinate[d]);
            if (!upward && adds_at_once) arriving_sum.add(q, own.rays);
            if (field.packed()) field.store(d, 0, n, source.data());
          });
        };
        if (!new_slopes) {
#pragma omp for schedule(dynamic, 1)
          for (std::size_t q = 0; q < group.size(); ++q) march_one(q);
          continue;
        }
        // Moments are added in the order of the ordinates, whichever threads march them.
#pragma omp for schedule(dynamic, 1) ordered
        for (std::size_t q = 0; q < group.size(); ++q) {
          march_one(q);
#pragma omp ordered
          errors.run([&] {
            const Real weight = static_cast<Real>(ordinates.weight[group[q]]);
            for (std::size_t axis = 0; axis < 3; ++axis) {
              const Real* __restrict const from = own.moment[axis].data();
              Real* __restrict const to = work.moment[axis].data();
              if (q == 0) {
                for (std::size_t c = 0; c < n; ++c) to[c] = weight * from[c];
              } else {
                for (std::size_t c = 0; c < n; ++c) to[c] += weight * from[c];
              }
            }
          });
        }
        const int octant = octant_of(ordinates.direction[group.front()]);
#pragma omp single
        errors.run([&] {
          for (auto& axis : slopes->of_radiance[octant]) axis.resize(n + lane_padding);
        });
        system.slopes->team_fit(system.cells->rows, octant, work.moment, slopes->of_radiance[octant]);
      }
    }
    errors.rethrow();
  };

  SweepFluxes<Real> fluxes;
  march_ordinates(false);
  for (int d = 0; !adds_at_once && d < ordinates.size(); ++d) {
    if (!arriving[d].radiance.empty()) add_arriving(arriving[d], ordinates, d, box, arriving_flux);
  }
  if (share != nullptr) {
    gather_arriving_flux(*share, columns, arriving_flux);
    if (!adds_at_once) gather_arriving(*share, ordinates, columns, arriving);
  }
  ground = system.ground.reflect(arriving, arriving_flux, system.beam.surface_flux, ordinates, box);
  fluxes.surface_flux = ground.flux;
  fluxes.surface_absorbed = ground.absorbed;
  if (record && !system.ground.is_lambertian()) {
    for (const ArrivingRays<Real>& rays : arriving)
      fluxes.surface_arriving.push_back(rays.radiance.empty() ? std::vector<Real>() : rays.by_column(box));
  }
  march_ordinates(true);
  if (share != nullptr) {
    gather_fluxes(*share, of_ordinate, record ? static_cast<std::size_t>(levels) : 0);
  } else if (new_slopes) {
    system.slopes->scatter(*system.cells, field, *slopes);
    slopes->fitted = true;
  }

  if (record) {
    fluxes.profile_up.assign(levels, 0.);
    fluxes.profile_down.assign(levels, 0.);
  }
  if (keep_columns) {
    fluxes.column_up.assign(columns * levels, 0.);
    fluxes.column_down.assign(columns * levels, 0.);
  }
  for (int d = 0; d < ordinates.size(); ++d) {
    const bool upward = ordinates.direction[d].z() > 0;
    const double power = ordinates.weight[d] * std::abs(ordinates.direction[d].z());
    const double per_column = power / static_cast<double>(columns);
    if (upward) fluxes.up_top += per_column * of_ordinate[d].out;
    fluxes.side_gain += per_column * of_ordinate[d].sides.entered_sides;
    fluxes.side_loss += per_column * of_ordinate[d].sides.left_sides;
    if (record) {
      std::vector<double>& profile = upward ? fluxes.profile_up : fluxes.profile_down;
      for (int e = 0; e < levels; ++e) profile[e] += per_column * of_ordinate[d].profile[e];
    }
    if (keep_columns) {
      std::vector<double>& column = upward ? fluxes.column_up : fluxes.column_down;
      for (std::size_t m = 0; m < column.size(); ++m) column[m] += power * static_cast<double>(passing[d][m]);
    }
  }
  return fluxes;
}

#define CLOUDBOW_INSTANTIATE(Real)                                                                                 \
  template SweepFluxes<Real> sweep<Real>(const TransportSystem<Real>&, AngularField<Real>&, bool,                  \
                                         SweepWorkspace<Real>&, LightSlopes<Real>*, const OrdinateShare*);         \
  template void finish_slopes<Real>(const TransportSystem<Real>&, const OrdinateShare&, const AngularField<Real>&, \
                                    LightSlopes<Real>&)
CLOUDBOW_INSTANTIATE(float);
CLOUDBOW_INSTANTIATE(double);
#undef CLOUDBOW_INSTANTIATE

}  // namespace cloudbow
