// Fluxes between bottom and top: one forward march for each direction, its light in bands of the distance it has come.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include "cloudbow/core/parallel_errors.hpp"
#include "transport/gather/gather.hpp"
#include "transport/gather/gather_classes.hpp"
#include "transport/gather/level_plan.hpp"
#include "transport/gather/light_slots.hpp"
#include "transport/gather/plane_blur.hpp"
#include "transport/gather/source_gradients.hpp"

namespace cloudbow {
namespace {

// Directions are shared out over these many sums, whatever the number of threads, so that sums have one order.
constexpr std::size_t most_groups = 4;
constexpr double most_sum_bytes = 1.5e8;  // of all groups, unless one alone takes more

// By the box alone, so that a level has the same bits whichever others are requested.
std::size_t groups_for(const BoxGrid& box) {
  constexpr double usual_planes = 10;  // of a level
  const double group = usual_planes * box.nz() * static_cast<double>(box.columns() * sizeof(float));
  return std::clamp(static_cast<std::size_t>(most_sum_bytes / group), std::size_t{1}, most_groups);
}

// Work arrays of one group of directions, and its sums.
template <class Real>
struct Workspace {
  std::vector<Slot<Real>> slots;
  std::vector<Slot<Real>*> crossing;       // slots whose light crosses a level
  std::vector<CarriedRays<Real>> carried;  // their rays
  struct Entry {
    const Real* rays;
    Real scale;
    Real* plane;
  };
  std::vector<Entry> entries;  // of sums at an interface
  std::vector<Real> sent, ground;
  Slot<Real> dark;  // light of cells that only absorb
  LinearSource<Real> own;
  std::vector<std::vector<Real>> sums;  // [planes][columns]; empty: no light that varies
  std::vector<double> same_everywhere;  // [planes] light of all columns beside them

  void prepare(int count, std::size_t columns, std::size_t cells, std::size_t planes) {
    slots.assign(static_cast<std::size_t>(count), Slot<Real>{std::vector<Real>(columns + lane_padding)});
    dark = slots.front();
    sent.resize(cells + lane_padding);
    sums.assign(planes, {});
    same_everywhere.assign(planes, 0.);
  }
};

template <class Real>
class LevelGather {
 public:
  LevelGather(const GatherScene<Real>& scene, bool upward, std::span<const int> edges)
      : scene_(scene),
        box_(scene.box),
        rows_(scene.cells.rows),
        upward_(upward),
        columns_(scene.box.columns()),
        levels_(edges.size()),
        plan_(march_plan(scene.box, emitting_levels(scene), upward, edges)) {}

  std::vector<float> flux(std::vector<GatherDirection> directions) {
    const std::vector<SpreadClass> classes = spread_classes(directions);
    const SumPlanes planes(plan_, box_, levels_, classes);
    const std::size_t groups = groups_for(box_);
    std::vector<Workspace<Real>> work(groups);
    for (const SpreadClass& alike : classes) {
      ParallelErrors errors;
#pragma omp parallel for schedule(dynamic, 1)
      for (std::size_t g = 0; g < groups; ++g) {
        errors.run([&] {
          if (alike.first == 0) work[g].prepare(plan_.slots, columns_, rows_.largest_level(), planes.size());
          for (std::size_t q = alike.first + g; q < alike.last; q += groups)
            march(directions[q], q, alike.spread, planes, work[g]);
        });
      }
      errors.rethrow();
    }
    double powers = 0;
    for (const GatherDirection& direction : directions) powers += power(direction);
    return blurred(planes, work, powers);
  }

 private:
  static std::vector<bool> emitting_levels(const GatherScene<Real>& scene) {
    std::vector<bool> emits;
    const ActiveRows& rows = scene.cells.rows;
    for (int k = 0; k < scene.box.nz(); ++k)
      emits.push_back(scene.reference != 0 ? rows.level_cell[k + 1] > rows.level_cell[k] : scene.cells.sends_light(k));
    return emits;
  }

  // @param powers sum over the directions.
  std::vector<float> blurred(const SumPlanes& planes, std::vector<Workspace<Real>>& work, double powers) const {
    ParallelErrors errors;
#pragma omp parallel for schedule(dynamic, 1)
    for (std::size_t p = 0; p < planes.size(); ++p) {
      errors.run([&] {
        std::vector<Real>& sum = work[0].sums[p];
        for (std::size_t g = 1; g < work.size(); ++g) {
          std::vector<Real>& of_group = work[g].sums[p];
          if (sum.empty()) {
            sum.swap(of_group);
            continue;
          }
          if (of_group.empty()) continue;
          const Real* __restrict const more = of_group.data();
          for (std::size_t c = 0; c < columns_; ++c) sum[c] += more[c];
        }
        if (!sum.empty()) blur_plane(sum, box_, planes.width_m(p));
      });
    }
    errors.rethrow();
    std::vector<float> flux(levels_ * columns_, static_cast<float>(powers * scene_.reference));
    for (std::size_t p = 0; p < planes.size(); ++p) {
      const std::vector<Real>& sum = work[0].sums[p];
      float* __restrict const to = flux.data() + static_cast<std::size_t>(planes.level(p)) * columns_;
      double more = 0;
      for (const Workspace<Real>& group : work) more += group.same_everywhere[p];
      for (std::size_t c = 0; c < columns_; ++c)
        to[c] += static_cast<float>(more + (sum.empty() ? 0. : static_cast<double>(sum[c])));
    }
    return flux;
  }

  // Rays of one direction through all levels up to the last that is wanted.
  void march(const GatherDirection& direction, std::size_t place, double spread, const SumPlanes& planes,
             Workspace<Real>& work) const {
    const Direction& travel = direction.travel;
    const LaunchPlace start = launch_place(place, true);
    const int count = static_cast<int>(plan_.steps.size());
    const LevelRange range = upward_ ? LevelRange{0, count} : LevelRange{box_.nz() - count, box_.nz()};
    const PathPattern pattern = scene_.path(make_path_pattern(box_, travel, start.x, start.y, false, range));
    const SourceAlong<Real> source = scene_.source->along(travel, power(direction));
    const CellView<Real> cells = cells_along(scene_, travel, work.own);
    const Real weight = static_cast<Real>(power(direction));
    std::vector<double> side;
    if (!box_.periodic && scene_.side_radiance) side = scene_.side_radiance(travel);
    const Real reference = weight * static_cast<Real>(scene_.reference);
    const bool lit_from_beyond = enter_box(travel, weight, work) || !side.empty();
    if (!box_.periodic) work.slots[boundary_slot].write(columns_);
    for (int step = 0; step < count; ++step) {
      const LevelPlan& plan = plan_.steps[step];
      const int level = pattern.level(step);
      work.crossing.clear();
      for (const int slot : plan.carried) {
        if (slot != boundary_slot || lit_from_beyond) work.crossing.push_back(&work.slots[slot]);
      }
      const std::size_t first_cell = rows_.level_cell[level];
      if (plan.fresh >= 0) {
        work.slots[plan.fresh].set(reference);
        source.fill(first_cell, rows_.level_cell[level + 1] - first_cell, work.sent.data());
      } else {  // its cells only absorb: the kernel adds zeros
        std::fill_n(work.sent.begin(), rows_.level_cell[level + 1] - first_cell + lane_padding, Real(0));
      }
      if (box_.periodic && crosses_in_air(pattern, step, rows_, cells)) {
        for_source_of(cells, [&](auto linear) { cross_in_air<linear>(pattern, step, cells, plan.fresh, work); });
      } else {
        const auto outside = [&](double at) {
          if (side.empty()) return -reference;
          const int below = upward_ ? level : level + 1, above = upward_ ? level + 1 : level;
          return weight * static_cast<Real>((1 - at) * side[below] + at * side[above]) - reference;
        };
        cross(pattern, step, cells, plan.fresh, reference, work, outside);
      }
      if (plan.fresh >= 0) work.slots[plan.fresh].how.offset -= static_cast<double>(reference);
      for (const auto& [from, into] : plan.merges) work.slots[into].add(work.slots[from], columns_);
      if (plan.level < 0) continue;
      work.entries.clear();
      const auto enter = [&](const Slot<Real>& slot, int plane) {
        const auto at = static_cast<std::size_t>(plane);
        work.same_everywhere[at] += slot.how.offset;
        if (slot.is_same_everywhere()) return;
        std::vector<Real>& sum = work.sums[at];
        if (sum.empty()) sum.resize(columns_);
        work.entries.push_back({slot.rays.data(), static_cast<Real>(slot.how.scale), sum.data()});
      };
      if (lit_from_beyond) enter(work.slots[boundary_slot], plan.level);
      for (const auto& booking : plan.bookings)
        enter(work.slots[booking.slot], planes.plane(plan.level, spread, booking.distance_m));
      book(pattern, step, work.entries);
    }
  }

  // Whether any light enters.
  bool enter_box(const Direction& travel, Real weight, Workspace<Real>& work) const {
    Slot<Real>& slot = work.slots[boundary_slot];
    const Real reference = static_cast<Real>(scene_.reference);
    if (!upward_) {
      slot.set(static_cast<double>(weight * (static_cast<Real>(scene_.sky_radiance) - reference)));
      return slot.how.offset != 0;
    }
    slot.set(0);
    slot.write(columns_);
    const Real* const leaving = scene_.ground->along(travel, work.ground);
    for (std::size_t c = 0; c < columns_; ++c) slot.rays[c] = weight * (leaving[c] - reference);
    return std::any_of(slot.rays.begin(), slot.rays.begin() + static_cast<std::ptrdiff_t>(columns_),
                       [](Real radiance) { return radiance != 0; });
  }

  // Slot for the light of a level's cells. @param fresh its index; -1: they send none.
  Slot<Real>& fresh_slot(int fresh, Workspace<Real>& work) const {
    if (fresh >= 0) return work.slots[fresh];
    work.dark.set(0);
    return work.dark;
  }

  // All rays cross a uniform level, or one with one block of air.
  template <bool linear>
  void cross_in_air(const PathPattern& pattern, int step, const CellView<Real>& cells, int fresh,
                    Workspace<Real>& work) const {
    const int level = pattern.level(step);
    const std::size_t first_cell = rows_.level_cell[level];
    if (first_cell == rows_.level_cell[level + 1]) return;
    const std::size_t block = rows_.level_cell[level + 1] - 1;
    const Real* const sent = work.sent.data();
    const std::span<const Chunk> chunks = rows_.levels.of(level);
    Slot<Real>& own = fresh_slot(fresh, work);
    if (!chunks.empty()) {
      constexpr double least_scale = 1e-3;  // with offsets of about 1, stored values stay far from the range of float
      for (Slot<Real>* const slot : work.crossing)
        if (slot->is_same_everywhere() || slot->how.scale < least_scale) slot->write(columns_);
      own.write(columns_);
    }
    for (std::uint32_t s = pattern.level_begin[step]; s < pattern.level_begin[step + 1]; ++s) {
      const Segment& segment = pattern.segments[s];
      if (segment.fraction <= 0) continue;
      const SegmentGeometry<Real> g(segment, pattern.chord_m[step]);
      const AirSource<linear, Real> air(g, cells.extinction[block], cells, sent, first_cell);
      const double absorbed = static_cast<double>(air.absorbed());
      const auto after_air = [absorbed](const Slot<Real>& slot, double emission) {
        StoredRays after = slot.how;
        after.cross_air(absorbed, emission);
        return after;
      };
      const StoredRays own_after = after_air(own, static_cast<double>(air.emission(block, false)));
      if (!chunks.empty()) {
        work.carried.clear();
        for (Slot<Real>* const slot : work.crossing) work.carried.emplace_back(*slot, after_air(*slot, 0));
        cross_chunks(chunks, wrapped(segment.shift_x, box_.nx), wrapped(segment.shift_y, box_.ny), box_.nx, box_.ny,
                     [&, into = CarriedRays<Real>(own, own_after)](std::size_t ray, std::size_t cell, int count) {
                       cross_sums<linear, true>(g, count, cells, cell, sent + (cell - first_cell), ray, into,
                                                std::span<const CarriedRays<Real>>(work.carried));
                     });
      }
      own.how = own_after;
      for (Slot<Real>* const slot : work.crossing) slot->how = after_air(*slot, 0);
    }
  }

  // All rays cross one level: their light is attenuated by exp(-t) = 1 - t phi1. The light of the cells
  // (docs/theory.md, "March along a ray") is added to the slot `fresh`; -1: they send none.
  template <class Outside>
  void cross(const PathPattern& pattern, int step, const CellView<Real>& cells, int fresh, Real reference,
             Workspace<Real>& work, const Outside& outside) const {
    const int level = pattern.level(step);
    const std::size_t first_cell = rows_.level_cell[level];
    const double chord = pattern.chord_m[step];
    const Real* const sent = work.sent.data();
    work.carried.clear();
    for (Slot<Real>* const slot : work.crossing) {
      slot->write(columns_);
      work.carried.emplace_back(slot->rays.data());
    }
    Real* sum = nullptr;
    if (fresh >= 0 || rows_.has_voxels(level)) {
      Slot<Real>& own = fresh_slot(fresh, work);
      own.write(columns_);
      sum = own.rays.data();
    }
    const auto enter = [&](const Segment& segment, double at) {
      if (box_.periodic) return;
      for_rays_through_side(segment, box_.nx, box_.ny, [&](std::size_t ray) {
        for (const CarriedRays<Real>& slot : work.carried) slot.rays[ray] = 0;
        if (sum != nullptr) sum[ray] = reference;
        work.slots[boundary_slot].rays[ray] = outside(at);
      });
    };
    for_source_of(cells, [&](auto linear) {
      const auto begin = [&](const Segment& segment) {
        return [&, g = SegmentGeometry<Real>(segment, chord)](std::size_t ray, std::size_t cell, int count) {
          cross_sums<linear, false>(g, count, cells, cell, sent + (cell - first_cell), ray, CarriedRays<Real>(sum),
                                    std::span<const CarriedRays<Real>>(work.carried));
        };
      };
      const auto begin_air = [&](const Segment& segment) {
        const Real extinction = cells.extinction[rows_.air[level].first_cell];
        const AirSource<linear, Real> air({segment, chord}, extinction, cells, sent, first_cell);
        return AirSums<linear, Real>(air, sum, work.carried);
      };
      cross_level(pattern, step, level, rows_, begin, begin_air, enter);
    });
  }

  // Light counts for the column that its ray is in after the step.
  void book(const PathPattern& pattern, int step, std::span<const typename Workspace<Real>::Entry> entries) const {
    for_shifted_rows(pattern.shift_x(step + 1), pattern.shift_y(step + 1), box_.nx, box_.ny,
                     [&](std::size_t column, std::size_t ray, int n) {
                       for (const auto& entry : entries) {
                         Real* __restrict const to = entry.plane + column;
                         const Real* __restrict const from = entry.rays + ray;
#pragma omp simd
                         for (int i = 0; i < n; ++i) to[i] += entry.scale * from[i];
                       }
                     });
  }

  const GatherScene<Real>& scene_;
  const BoxGrid& box_;
  const ActiveRows& rows_;
  bool upward_;
  std::size_t columns_;
  std::size_t levels_;
  MarchPlan plan_;
};

}  // namespace

std::size_t level_gather_bytes(const BoxGrid& box, std::span<const int> edges, int directions) {
  if (edges.empty()) return 0;
  const std::vector<bool> all(static_cast<std::size_t>(box.nz()), true);
  auto set = gather_directions(directions, true, std::nullopt);
  const SumPlanes planes(march_plan(box, all, true, edges), box, edges.size(), spread_classes(set));
  const std::size_t bytes = planes.size() * box.columns() * sizeof(float);
  return bytes * groups_for(box) + edges.size() * box.columns() * sizeof(float);
}

template <class Real>
std::vector<float> gather_level_fluxes(const GatherScene<Real>& scene, std::span<const int> edges, bool upward,
                                       const std::vector<GatherDirection>& directions) {
  return LevelGather<Real>(scene, upward, edges).flux(directions);
}

template std::vector<float> gather_level_fluxes<float>(const GatherScene<float>&, std::span<const int>, bool,
                                                       const std::vector<GatherDirection>&);
template std::vector<float> gather_level_fluxes<double>(const GatherScene<double>&, std::span<const int>, bool,
                                                        const std::vector<GatherDirection>&);

}  // namespace cloudbow
