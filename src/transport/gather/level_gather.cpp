// Fluxes between bottom and top: one forward march for each direction, its light in bands of the distance it has come.
#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "cloudbow/core/parallel_errors.hpp"
#include "transport/gather/gather.hpp"
#include "transport/gather/gather_classes.hpp"
#include "transport/gather/light_slots.hpp"
#include "transport/gather/march_schedule.hpp"
#include "transport/gather/plane_blur.hpp"
#include "transport/gather/plane_sums.hpp"
#include "transport/gather/source_gradients.hpp"

namespace cloudbow {
namespace {

// Each quadrant of directions has sums of its own. Those that are made at a time take no more than this. But one is
// always made.
constexpr double most_bytes_at_a_time = 1.5e8;

// By the box alone, so that a level has the same bits whichever others are requested.
double bytes_of_quadrant(const BoxGrid& box) {
  constexpr double usual_planes = 10;  // of a level
  return usual_planes * box.nz() * static_cast<double>(box.columns() * sizeof(float));
}

int quadrants_at_a_time(const BoxGrid& box) {
  return std::clamp(static_cast<int>(most_bytes_at_a_time / bytes_of_quadrant(box)), 1, quadrants);
}

// Directions of a quadrant that go through the levels together: a plane of sums is then fetched once for all of them.
// The bits do not depend on their number.
constexpr std::size_t most_together = 8;
constexpr double most_march_bytes = 6.4e7;

// Memory of one direction.
// @param cells whose source and slopes it keeps.
template <class Real>
std::size_t march_bytes(std::size_t slots, std::size_t columns, std::size_t cells) {
  constexpr std::size_t values_of_cell = 5;  // of a LinearSource
  return (slots * columns + values_of_cell * cells) * sizeof(Real);
}

template <class Real>
std::size_t directions_together(std::size_t slots, std::size_t columns, std::size_t cells) {
  const double bytes = static_cast<double>(march_bytes<Real>(slots, columns, cells));
  return std::clamp(static_cast<std::size_t>(most_march_bytes / bytes), std::size_t{1}, most_together);
}

// Light of one direction on its way through the levels.
template <class Real>
struct DirectionMarch {
  PathPattern pattern{};
  SourceByLevel<Real> source{};
  Real weight = 0;
  Real reference = 0;
  bool lit_from_beyond = false;
  std::vector<double> side;
  std::vector<Slot<Real>> slots;
  Slot<Real> dark;  // light of cells that only absorb

  DirectionMarch(std::size_t count, std::size_t columns)
      : slots(count, Slot<Real>{std::vector<Real>(columns + lane_padding)}), dark(slots.front()) {}
};

// Rays of a slot that are added to a plane of sums.
template <class Real>
struct Booking {
  std::size_t plane;
  int shift_x, shift_y;  // of rays to their columns, from 0 up to nx - 1 and ny - 1
  const Real* rays;
  Real scale;
};

// Work arrays of a thread, and the sums of its present quadrant of directions.
template <class Real>
struct Workspace {
  std::vector<DirectionMarch<Real>> marches;
  std::vector<Slot<Real>*> crossing;       // slots whose light crosses a level
  std::vector<CarriedRays<Real>> carried;  // their rays
  std::vector<Booking<Real>> bookings;     // at an interface
  std::vector<Real> ground;
  PlaneSums<Real> sums;

  Workspace(std::size_t slots, std::size_t columns, std::size_t cells, std::size_t planes) : sums(planes) {
    const std::size_t together = directions_together<Real>(slots, columns, cells);
    for (std::size_t d = 0; d < together; ++d) marches.emplace_back(slots, columns);
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
        schedule_(march_schedule(scene.box, emitting_levels(scene), upward, edges)) {}

  // @param one_by_one quadrants of directions
  std::vector<float> flux(std::vector<GatherDirection> directions, bool one_by_one, const OrdinateShare* share) {
    const std::vector<SpreadClass> classes = spread_classes(directions);
    const SumPlanes planes(schedule_, box_, levels_, classes);
    double powers = 0;
    for (const GatherDirection& direction : directions) powers += power(direction);
    std::vector<int> own;  // quadrants
    for (int quadrant = 0; quadrant < quadrants; ++quadrant) {
      if (share == nullptr || share->has_octant(octant(quadrant))) own.push_back(quadrant);
    }
    const bool adds = share == nullptr || share->is_first();
    if (one_by_one) return flux_one_by_one(directions, classes, planes, own, powers, share);
    PlaneSums<Real> all(adds ? planes.size() : 0);
    std::vector<PlaneSums<Real>> to_send;
    march_quadrants(directions, classes, planes, own, quadrants_at_a_time(box_), [&](PlaneSums<Real>& sums) {
      if (adds) {
        all.add(sums);
      } else {
        to_send.push_back(std::move(sums));
        sums = PlaneSums<Real>(planes.size());
      }
    });
    for (const PlaneSums<Real>& sums : to_send) send_sums(share->ranks(), 0, sums);
    if (!adds) return {};
    for_quadrants_of_others(share, [&](int owner) { receive_and_add(share->ranks(), owner, columns_, all); });
    std::vector<float> flux(levels_ * columns_, static_cast<float>(powers * scene_.reference));
    add_blurred(planes, all, flux);
    return flux;
  }

 private:
  // Number of cells whose source and slopes one direction keeps. Slopes from differences are made for all at once.
  std::size_t cells_kept() const {
    return scene_.linear_source && scene_.slopes == nullptr ? rows_.size() : rows_.largest_level();
  }
  static std::vector<bool> emitting_levels(const GatherScene<Real>& scene) {
    std::vector<bool> emits;
    const ActiveRows& rows = scene.cells.rows;
    for (int k = 0; k < scene.box.nz(); ++k)
      emits.push_back(scene.reference != 0 ? rows.level_cell[k + 1] > rows.level_cell[k] : scene.cells.sends_light(k));
    return emits;
  }

  int octant(int quadrant) const { return quadrant + (upward_ ? octants / 2 : 0); }

  // Directions of one spread that belong to a quadrant.
  void march_class(std::span<const GatherDirection> directions, const SpreadClass& alike, int quadrant,
                   const SumPlanes& planes, Workspace<Real>& own) const {
    const auto of_quadrant = by_quadrant(directions, alike.first, alike.last)[static_cast<std::size_t>(quadrant)];
    for (std::size_t first = 0; first < of_quadrant.size(); first += own.marches.size()) {
      const std::size_t count = std::min(own.marches.size(), of_quadrant.size() - first);
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t q = of_quadrant[first + i];
        start(directions[q], q, own.marches[i], own.ground);
      }
      march(count, alike.spread, planes, own);
    }
  }

  // Calls take(sums) for each of these quadrants, in their order, whichever threads march them.
  template <class Take>
  void march_quadrants(std::span<const GatherDirection> directions, const std::vector<SpreadClass>& classes,
                       const SumPlanes& planes, const std::vector<int>& own, int at_a_time, const Take& take) const {
    const auto slots = static_cast<std::size_t>(schedule_.slots);
    ParallelErrors errors;
    const int threads = std::min(omp_get_max_threads(), at_a_time);
#pragma omp parallel num_threads(threads)
    {
      std::optional<Workspace<Real>> work;
#pragma omp for schedule(dynamic, 1) ordered
      for (std::size_t q = 0; q < own.size(); ++q) {
        errors.run([&] {
          if (!work) work.emplace(slots, columns_, cells_kept(), planes.size());
          work->sums.clear();
          for (const SpreadClass& alike : classes) march_class(directions, alike, own[q], planes, *work);
        });
#pragma omp ordered
        errors.run([&] {
          if (work) take(work->sums);
        });
      }
    }
    errors.rethrow();
  }

  // For boxes so large that the sums of two quadrants take too much memory: those of one are blurred before the next is
  // marched. That is four times as much to blur, a tenth of a run. Ranks then exchange fluxes, which are fewer.
  std::vector<float> flux_one_by_one(std::span<const GatherDirection> directions,
                                     const std::vector<SpreadClass>& classes, const SumPlanes& planes,
                                     const std::vector<int>& own, double powers, const OrdinateShare* share) const {
    const bool adds = share == nullptr || share->is_first();
    std::vector<float> flux(adds ? levels_ * columns_ : 0, static_cast<float>(powers * scene_.reference));
    const auto add = [&](std::span<const float> of_quadrant) {
      for (std::size_t c = 0; c < flux.size(); ++c) flux[c] += of_quadrant[c];
    };
    std::vector<std::vector<float>> to_send;
    march_quadrants(directions, classes, planes, own, 1, [&](PlaneSums<Real>& sums) {
      std::vector<float> of_quadrant(levels_ * columns_, 0.F);
      add_blurred(planes, sums, of_quadrant);
      if (adds) {
        add(of_quadrant);
      } else {
        to_send.push_back(std::move(of_quadrant));
      }
    });
    for (const std::vector<float>& of_quadrant : to_send) {
      const std::array<Ranks::Outgoing, 1> outgoing{{{0, std::as_bytes(std::span(of_quadrant))}}};
      share->ranks().exchange(outgoing, {});
    }
    if (!adds) return {};
    for_quadrants_of_others(share, [&](int owner) {
      std::vector<float> of_quadrant(flux.size());
      const std::array<Ranks::Incoming, 1> incoming{{{owner, std::as_writable_bytes(std::span(of_quadrant))}}};
      share->ranks().exchange({}, incoming);
      add(of_quadrant);
    });
    return flux;
  }

  // Calls receive(owner) for the quadrants that other ranks have marched, in their order. At the first rank.
  template <class Receive>
  void for_quadrants_of_others(const OrdinateShare* share, const Receive& receive) const {
    for (int quadrant = 0; share != nullptr && quadrant < quadrants; ++quadrant) {
      const int owner = share->owner_of_octant(octant(quadrant));
      if (owner != 0) receive(owner);
    }
  }

  // @param sums are blurred in place. @param flux [levels][columns]
  void add_blurred(const SumPlanes& planes, PlaneSums<Real>& sums, std::vector<float>& flux) const {
    ParallelErrors errors;
#pragma omp parallel for schedule(dynamic, 1)
    for (std::size_t p = 0; p < planes.size(); ++p) {
      errors.run([&] {
        if (!sums.columns[p].empty()) blur_plane(sums.columns[p], box_, planes.width_m(p));
      });
    }
    errors.rethrow();
    for (std::size_t p = 0; p < planes.size(); ++p) {
      const std::vector<Real>& sum = sums.columns[p];
      float* __restrict const to = flux.data() + static_cast<std::size_t>(planes.level(p)) * columns_;
      const double more = sums.everywhere[p];
      for (std::size_t c = 0; c < columns_; ++c)
        to[c] += static_cast<float>(more + (sum.empty() ? 0. : static_cast<double>(sum[c])));
    }
  }

  // Rays of one direction before they enter the box.
  // @param ground room for light that leaves the ground.
  void start(const GatherDirection& direction, std::size_t place, DirectionMarch<Real>& rays,
             std::vector<Real>& ground) const {
    const Direction& travel = direction.travel;
    const LaunchPlace at = launch_place(place, true);
    const int count = static_cast<int>(schedule_.steps.size());
    const LevelRange range = upward_ ? LevelRange{0, count} : LevelRange{box_.nz() - count, box_.nz()};
    rays.pattern = scene_.path(make_path_pattern(box_, travel, at.x, at.y, false, range));
    rays.source.start(scene_, travel);
    rays.weight = static_cast<Real>(power(direction));
    rays.reference = rays.weight * static_cast<Real>(scene_.reference);
    rays.side.clear();
    if (!box_.periodic && scene_.side_radiance) rays.side = scene_.side_radiance(travel);
    rays.lit_from_beyond = enter_box(travel, rays, ground) || !rays.side.empty();
    if (!box_.periodic) rays.slots[boundary_slot].write(columns_);
  }

  // Rays of `count` directions through all levels up to the last that is wanted.
  void march(std::size_t count, double spread, const SumPlanes& planes, Workspace<Real>& work) const {
    for (std::size_t step = 0; step < schedule_.steps.size(); ++step) {
      const LevelStep& now = schedule_.steps[step];
      work.bookings.clear();
      for (std::size_t d = 0; d < count; ++d) {
        DirectionMarch<Real>& rays = work.marches[d];
        cross_step(static_cast<int>(step), rays, work);
        if (now.level < 0) continue;
        const int shift_x = wrapped(rays.pattern.shift_x(static_cast<int>(step) + 1), box_.nx);
        const int shift_y = wrapped(rays.pattern.shift_y(static_cast<int>(step) + 1), box_.ny);
        const auto enter = [&](const Slot<Real>& slot, int plane) {
          const auto at = static_cast<std::size_t>(plane);
          work.sums.everywhere[at] += slot.how.offset;
          if (slot.is_same_everywhere()) return;
          work.bookings.push_back({at, shift_x, shift_y, slot.rays.data(), static_cast<Real>(slot.how.scale)});
        };
        if (rays.lit_from_beyond) enter(rays.slots[boundary_slot], now.level);
        for (const auto& booking : now.bookings)
          enter(rays.slots[booking.slot], planes.plane(now.level, spread, booking.distance_m));
      }
      book(work);
    }
  }

  // Rays of one direction through one level.
  void cross_step(int step, DirectionMarch<Real>& rays, Workspace<Real>& work) const {
    const LevelStep& now = schedule_.steps[static_cast<std::size_t>(step)];
    const int level = rays.pattern.level(step);
    work.crossing.clear();
    for (const int slot : now.carried) {
      if (slot != boundary_slot || rays.lit_from_beyond) work.crossing.push_back(&rays.slots[slot]);
    }
    const std::size_t first_cell = rows_.level_cell[level];
    const CellView<Real> cells = rays.source.level(first_cell, rows_.level_cell[level + 1] - first_cell);
    if (now.fresh >= 0) {
      rays.slots[now.fresh].set(rays.reference);
      for (Real& sent : rays.source.value()) sent *= rays.weight;
    } else {  // its cells only absorb: the kernel adds zeros
      std::fill(rays.source.value().begin(), rays.source.value().end(), Real(0));
    }
    if (box_.periodic && crosses_in_air(rays.pattern, step, rows_, CellView<Real>(scene_.extinction(), {}))) {
      for_source_of(cells, [&](auto linear) { cross_in_air<linear>(step, now.fresh, cells, rays, work); });
    } else {
      const auto outside = [&](double at) {
        if (rays.side.empty()) return -rays.reference;
        const int below = upward_ ? level : level + 1, above = upward_ ? level + 1 : level;
        return rays.weight * static_cast<Real>((1 - at) * rays.side[below] + at * rays.side[above]) - rays.reference;
      };
      cross(step, now.fresh, cells, rays, work, outside);
    }
    if (now.fresh >= 0) rays.slots[now.fresh].how.offset -= static_cast<double>(rays.reference);
    for (const auto& [from, into] : now.merges) rays.slots[into].add(rays.slots[from], columns_);
  }

  // Whether any light enters.
  bool enter_box(const Direction& travel, DirectionMarch<Real>& rays, std::vector<Real>& ground) const {
    Slot<Real>& slot = rays.slots[boundary_slot];
    const Real weight = rays.weight;
    const Real reference = static_cast<Real>(scene_.reference);
    if (!upward_) {
      slot.set(static_cast<double>(weight * (static_cast<Real>(scene_.sky_radiance) - reference)));
      return slot.how.offset != 0;
    }
    slot.set(0);
    slot.write(columns_);
    const Real* const leaving = scene_.ground->along(travel, ground);
    for (std::size_t c = 0; c < columns_; ++c) slot.rays[c] = weight * (leaving[c] - reference);
    return std::any_of(slot.rays.begin(), slot.rays.begin() + static_cast<std::ptrdiff_t>(columns_),
                       [](Real radiance) { return radiance != 0; });
  }

  // Slot for the light of a level's cells. @param fresh its index; -1: they send none.
  static Slot<Real>& fresh_slot(int fresh, DirectionMarch<Real>& rays) {
    if (fresh >= 0) return rays.slots[fresh];
    rays.dark.set(0);
    return rays.dark;
  }

  // All rays cross a uniform level, or one with one block of air.
  template <bool linear>
  void cross_in_air(int step, int fresh, const CellView<Real>& cells, DirectionMarch<Real>& rays,
                    Workspace<Real>& work) const {
    const PathPattern& pattern = rays.pattern;
    const int level = pattern.level(step);
    const std::size_t first_cell = rows_.level_cell[level];
    if (first_cell == rows_.level_cell[level + 1]) return;
    const std::size_t block = rows_.level_cell[level + 1] - 1;
    const Real* const sent = rays.source.value().data();
    const std::span<const Chunk> chunks = rows_.levels.of(level);
    Slot<Real>& own = fresh_slot(fresh, rays);
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
      const AirSource<linear, Real> air(g, cells.extinction[block - first_cell], cells, sent, first_cell);
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
                       cross_sums<linear, true>(g, count, cells, cell - first_cell, sent + (cell - first_cell), ray,
                                                into, std::span<const CarriedRays<Real>>(work.carried));
                     });
      }
      own.how = own_after;
      for (Slot<Real>* const slot : work.crossing) slot->how = after_air(*slot, 0);
    }
  }

  // All rays cross one level: their light is attenuated by exp(-t) = 1 - t phi1. The light of the cells
  // (docs/theory.md, "March along a ray") is added to the slot `fresh`; -1: they send none.
  template <class Outside>
  void cross(int step, int fresh, const CellView<Real>& cells, DirectionMarch<Real>& rays, Workspace<Real>& work,
             const Outside& outside) const {
    const PathPattern& pattern = rays.pattern;
    const int level = pattern.level(step);
    const std::size_t first_cell = rows_.level_cell[level];
    const double chord = pattern.chord_m[step];
    const Real* const sent = rays.source.value().data();
    work.carried.clear();
    for (Slot<Real>* const slot : work.crossing) {
      slot->write(columns_);
      work.carried.emplace_back(slot->rays.data());
    }
    Real* sum = nullptr;
    if (fresh >= 0 || rows_.has_voxels(level)) {
      Slot<Real>& own = fresh_slot(fresh, rays);
      own.write(columns_);
      sum = own.rays.data();
    }
    const auto enter = [&](const Segment& segment, double at) {
      if (box_.periodic) return;
      for_rays_through_side(segment, box_.nx, box_.ny, [&](std::size_t ray) {
        for (const CarriedRays<Real>& slot : work.carried) slot.rays[ray] = 0;
        if (sum != nullptr) sum[ray] = rays.reference;
        rays.slots[boundary_slot].rays[ray] = outside(at);
      });
    };
    for_source_of(cells, [&](auto linear) {
      const auto begin = [&](const Segment& segment) {
        return [&, g = SegmentGeometry<Real>(segment, chord)](std::size_t ray, std::size_t cell, int count) {
          cross_sums<linear, false>(g, count, cells, cell - first_cell, sent + (cell - first_cell), ray,
                                    CarriedRays<Real>(sum), std::span<const CarriedRays<Real>>(work.carried));
        };
      };
      const auto begin_air = [&](const Segment& segment) {
        const Real extinction = cells.extinction[rows_.air[level].first_cell - first_cell];
        const AirSource<linear, Real> air({segment, chord}, extinction, cells, sent, first_cell);
        return AirSums<linear, Real>(air, sum, work.carried);
      };
      cross_level(pattern, step, level, rows_, begin, begin_air, enter);
    });
  }

  // Light counts for the column that its ray is in after the step. Some rows of a plane at a time: they stay in the
  // nearest cache while the light of all slots is added.
  void book(Workspace<Real>& work) const {
    constexpr int columns_at_a_time = 2048;
    const int rows = std::max(1, columns_at_a_time / box_.nx);
    std::vector<Booking<Real>>& bookings = work.bookings;
    // Stable: sums have the order of the directions.
    std::stable_sort(bookings.begin(), bookings.end(), [](const auto& a, const auto& b) { return a.plane < b.plane; });
    for (auto first = bookings.begin(); first != bookings.end();) {
      const auto last = std::find_if(first, bookings.end(), [&](const auto& b) { return b.plane != first->plane; });
      std::vector<Real>& plane = work.sums.columns[first->plane];
      if (plane.empty()) plane.resize(columns_ + lane_padding);
      for (int row = 0; row < box_.ny; row += rows) {
        for (auto booking = first; booking != last; ++booking)
          add_rows(*booking, row, std::min(box_.ny, row + rows), plane.data());
      }
      first = last;
    }
  }

  void add_rows(const Booking<Real>& booking, int first, int last, Real* plane) const {
    const auto nx = static_cast<std::size_t>(box_.nx);
    const auto shift = static_cast<std::size_t>(booking.shift_x);
    const Real scale = booking.scale;
    for (int row = first; row < last; ++row) {
      const int from_row = row - booking.shift_y + (row < booking.shift_y ? box_.ny : 0);
      const Real* __restrict const from = booking.rays + static_cast<std::size_t>(from_row) * nx;
      Real* __restrict const to = plane + static_cast<std::size_t>(row) * nx;
      add_run(from, nx - shift, scale, to + shift);
      add_run(from + (nx - shift), shift, scale, to);
    }
  }

  // Arrays have lane_padding behind them. Runs are short: a scalar loop over the last rays of each would take half the
  // time.
  static void add_run(const Real* from, std::size_t count, Real scale, Real* to) {
    using Rays = Pack<Real>;
    std::size_t i = 0;
    for (; i + Rays::size <= count; i += Rays::size)
      Rays::store_all(Rays::load(to + i) + scale * Rays::load(from + i), to + i);
    if (i < count)
      Rays::store(Rays::first(static_cast<int>(count - i)), Rays::load(to + i) + scale * Rays::load(from + i), to + i);
  }

  const GatherScene<Real>& scene_;
  const BoxGrid& box_;
  const ActiveRows& rows_;
  bool upward_;
  std::size_t columns_;
  std::size_t levels_;
  MarchSchedule schedule_;
};

}  // namespace

template <class Real>
std::size_t level_gather_bytes(const BoxGrid& box, std::size_t cells, std::span<const int> edges, int directions,
                               int threads) {
  if (edges.empty()) return 0;
  const std::vector<bool> all(static_cast<std::size_t>(box.nz()), true);
  auto set = gather_directions(directions, true, std::nullopt);
  const MarchSchedule schedule = march_schedule(box, all, true, edges);
  const SumPlanes planes(schedule, box, edges.size(), spread_classes(set));
  const auto slots = static_cast<std::size_t>(schedule.slots);
  const auto at_once = static_cast<std::size_t>(std::min(quadrants_at_a_time(box), threads));
  const std::size_t sums = planes.size() * box.columns() * sizeof(Real);
  const std::size_t marches =
      directions_together<Real>(slots, box.columns(), cells) * march_bytes<Real>(slots, box.columns(), cells);
  // The sums of all quadrants beside those of the quadrants that are marched, or the fluxes of one.
  return sums * (bytes_of_quadrant(box) > most_sum_bytes ? 1 : at_once + 1) + marches * at_once +
         edges.size() * box.columns() * sizeof(float);
}

template <class Real>
std::vector<float> gather_level_fluxes(const GatherScene<Real>& scene, std::span<const int> edges, bool upward,
                                       const std::vector<GatherDirection>& directions, const OrdinateShare* share,
                                       double most_bytes) {
  return LevelGather<Real>(scene, upward, edges).flux(directions, bytes_of_quadrant(scene.box) > most_bytes, share);
}

template std::size_t level_gather_bytes<float>(const BoxGrid&, std::size_t, std::span<const int>, int, int);
template std::size_t level_gather_bytes<double>(const BoxGrid&, std::size_t, std::span<const int>, int, int);
template std::vector<float> gather_level_fluxes<float>(const GatherScene<float>&, std::span<const int>, bool,
                                                       const std::vector<GatherDirection>&, const OrdinateShare*,
                                                       double);
template std::vector<float> gather_level_fluxes<double>(const GatherScene<double>&, std::span<const int>, bool,
                                                        const std::vector<GatherDirection>&, const OrdinateShare*,
                                                        double);

}  // namespace cloudbow
