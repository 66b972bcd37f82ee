// The order of work of a gather at levels: light that is kept apart, merges, and sums.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "cloudbow/medium/optical_grid.hpp"
#include "transport/gather/gather_classes.hpp"
#include "transport/gather/plane_blur.hpp"

namespace cloudbow {

constexpr double level_band_growth = 3;  // a band of several levels ends at most this many times as far as it begins
constexpr int boundary_slot = 0;         // light from beyond the box
/// Gaussian width as a fraction of the beam's spread: less than in gather_flux, because rays start in other places for
/// each direction, which smooths as well.
constexpr double level_blur_per_spread = .2;
constexpr double level_width_growth = 2;

/// State and sums of the rays of every direction in one level of the march. A slot is an array of rays.
struct LevelStep {
  int fresh = -1;                           // slot of the light of the level's cells; -1: it has none
  std::vector<int> carried;                 // slots whose light crosses the level
  std::vector<std::pair<int, int>> merges;  // {from, into} slots, after the level
  struct Booking {
    int slot;
    double distance_m;  // of height, from the origin of the light
  };
  int level = -1;                 // index among the wanted interfaces; -1: that after this level is not wanted
  std::vector<Booking> bookings;  // for each slot but that of the boundary
};

struct MarchSchedule {
  int slots = 1;
  std::vector<LevelStep> steps;
};

/// Bands are as in gather_flux: levels one by one next to an interface, more of them at a time further away. As the
/// march moves on, bands merge as soon as the distance to them allows.
///
/// @param emits [nz] whether light comes from a level.
inline MarchSchedule march_schedule(const BoxGrid& box, const std::vector<bool>& emits, bool upward,
                                    std::span<const int> edges) {
  struct Carried {
    int slot;
    double begin_m, end_m;  // height marched at its first and after its last level
  };
  MarchSchedule schedule;
  std::vector<Carried> bands;  // the most distant first
  std::vector<int> vacant;
  double marched_m = 0;
  const int steps = upward ? edges.back() : box.nz() - edges.front();
  for (int step = 0; step < steps; ++step) {
    const int k = upward ? step : box.nz() - 1 - step;
    LevelStep level;
    level.carried.push_back(boundary_slot);
    for (const Carried& band : bands) level.carried.push_back(band.slot);
    const double begin_m = marched_m;
    marched_m += box.thickness_m(k);
    if (emits[static_cast<std::size_t>(k)]) {
      if (vacant.empty()) vacant.push_back(schedule.slots++);
      level.fresh = vacant.back();
      vacant.pop_back();
      bands.push_back({level.fresh, begin_m, marched_m});
    }
    for (std::size_t b = 0; b + 1 < bands.size();) {
      const double near_m = marched_m - bands[b + 1].end_m, far_m = marched_m - bands[b].begin_m;
      if (far_m > level_band_growth * near_m * (1 + 1e-9)) {
        ++b;
        continue;
      }
      level.merges.emplace_back(bands[b + 1].slot, bands[b].slot);
      vacant.push_back(bands[b + 1].slot);
      bands[b].end_m = bands[b + 1].end_m;
      bands.erase(bands.begin() + static_cast<std::ptrdiff_t>(b) + 1);
    }
    const auto wanted = std::find(edges.begin(), edges.end(), upward ? k + 1 : k);
    if (wanted != edges.end()) {
      level.level = static_cast<int>(wanted - edges.begin());
      for (const Carried& band : bands)
        level.bookings.push_back({band.slot, marched_m - .5 * (band.begin_m + band.end_m)});
    }
    schedule.steps.push_back(std::move(level));
  }
  return schedule;
}

/// Planes of sums: for each wanted interface one without blur and one for each rounded width of blur that occurs there.
class SumPlanes {
 public:
  SumPlanes(const MarchSchedule& schedule, const BoxGrid& box, std::size_t levels, std::span<const SpreadClass> classes)
      : widths_(box, level_width_growth),
        plane_(levels, std::vector<int>(static_cast<std::size_t>(widths_.count()), -1)) {
    for (std::size_t level = 0; level < levels; ++level) plane_[level][0] = add(static_cast<int>(level), 0);
    for (const SpreadClass& alike : classes) {
      for (const LevelStep& step : schedule.steps) {
        for (const auto& booking : step.bookings) {
          const int width = rounded(alike.spread, booking.distance_m);
          int& plane = plane_[static_cast<std::size_t>(step.level)][static_cast<std::size_t>(width)];
          if (plane < 0) plane = add(step.level, width);
        }
      }
    }
  }

  std::size_t size() const { return level_.size(); }
  int level(std::size_t plane) const { return level_[plane]; }
  double width_m(std::size_t plane) const { return widths_.width_m(width_[plane]); }
  /// Plane for light in a direction of this spread.
  int plane(int level, double spread, double distance_m) const {
    return plane_[static_cast<std::size_t>(level)][static_cast<std::size_t>(rounded(spread, distance_m))];
  }

 private:
  int add(int level, int width) {
    level_.push_back(level);
    width_.push_back(width);
    return static_cast<int>(level_.size()) - 1;
  }
  int rounded(double spread, double distance_m) const {
    return widths_.number(level_blur_per_spread * spread * distance_m);
  }

  BlurWidths widths_;
  std::vector<std::vector<int>> plane_;  // [level][number of the width]; -1: does not occur
  std::vector<int> level_, width_;       // [planes]
};

}  // namespace cloudbow
