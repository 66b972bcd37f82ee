// Light of several levels, side by side in the rays of one direction.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "transport/gather/air_source.hpp"

namespace cloudbow {

/// Light of some levels in the rays of a direction.
template <class Real>
struct Slot {
  std::vector<Real> rays;       // [columns + lane_padding], as `how` says
  bool same_everywhere = true;  // all rays have how.offset, and `rays` nothing
  StoredRays how{0, 0};

  void set(double radiance) {
    same_everywhere = true;
    how = {0, radiance};
  }
  // True too if what varied has faded.
  bool is_same_everywhere() const {
    constexpr double faded = 1e-20;
    return same_everywhere || how.scale < faded;
  }
  // Makes the values of `rays` the radiances.
  void write(std::size_t columns) {
    if (is_same_everywhere()) {
      std::fill_n(rays.begin(), columns, static_cast<Real>(how.offset));
      same_everywhere = false;
      how = {};
    } else {
      how.write(rays.data(), columns);
    }
  }
  // Adds the light of another slot, whose rays may be taken.
  void add(Slot& other, std::size_t columns) {
    if (!other.is_same_everywhere()) {
      if (is_same_everywhere()) {
        rays.swap(other.rays);
        same_everywhere = false;
        how.scale = other.how.scale;
      } else {
        const Real by = static_cast<Real>(other.how.scale / how.scale);
        const Real* __restrict const more = other.rays.data();
        Real* __restrict const sum = rays.data();
        for (std::size_t m = 0; m < columns; ++m) sum[m] += by * more[m];
      }
    }
    how.offset += other.how.offset;
  }
};

/// A slot's rays in one segment: how they are stored before and after it.
template <class Real>
struct CarriedRays {
  Real* rays;
  Real scale = 1, offset = 0;
  Real inverse_after = 1, offset_after = 0;

  explicit CarriedRays(Real* stored) : rays(stored) {}
  CarriedRays(Slot<Real>& slot, const StoredRays& after)
      : rays(slot.rays.data()),
        scale(static_cast<Real>(slot.how.scale)),
        offset(static_cast<Real>(slot.how.offset)),
        inverse_after(static_cast<Real>(1 / after.scale)),
        offset_after(static_cast<Real>(after.offset)) {}
};

/// `count` <= lanes rays cross as many cells: their light is added to `fresh` (docs/theory.md, Eq. 20), and every array
/// of `carried` is attenuated.
/// @tparam in_air air changes how rays are stored, else they are as they are.
template <bool linear, bool in_air, class Real>
[[gnu::always_inline]] inline void cross_sums(const SegmentGeometry<Real>& g, int count, const CellView<Real>& cells,
                                              std::size_t cell, const Real* __restrict sent, std::size_t ray,
                                              const CarriedRays<Real>& fresh,
                                              std::span<const CarriedRays<Real>> carried) {
  const Real* __restrict const sigma = cells.extinction + cell;
  const std::size_t first = linear ? cell : 0;
  const Real* __restrict const x = cells.gradient[0] + first;
  const Real* __restrict const y = cells.gradient[1] + first;
  const Real* __restrict const z = cells.gradient[2] + first;
  Real* __restrict const sum = fresh.rays + ray;
  std::array<Real, lanes> faded;
  for_lanes<Real>(
      count, [ =, &faded ](int i, bool active) __attribute__((always_inline)) {
        Crossing<Real> crossing(optical_path(sigma[i], g.length));
        if (!active) crossing.t = 0;  // a lane without a cell changes nothing
        Real emitted = crossing.phi.phi1;
        if constexpr (linear) emitted = crossing.emitted(g.at_entry(x[i], y[i], z[i]), g.at_exit(x[i], y[i], z[i]));
        faded[i] = crossing.absorbed();
        if constexpr (in_air) {
          const Real light = crossing.leaving(fresh.scale * sum[i] + fresh.offset, sent[i] * emitted);
          sum[i] = active ? fresh.inverse_after * (light - fresh.offset_after) : sum[i];
        } else {
          sum[i] = crossing.leaving(sum[i], sent[i] * emitted);
        }
      });
  for (const CarriedRays<Real>& slot : carried) {
    Real* __restrict const light = slot.rays + ray;
    for_lanes<Real>(
        count, [&, light ](int i, bool active) __attribute__((always_inline)) {
          if constexpr (in_air) {
            const Real here = slot.scale * light[i] + slot.offset;
            light[i] = active ? slot.inverse_after * (here - faded[i] * here - slot.offset_after) : light[i];
          } else {
            light[i] -= active ? faded[i] * light[i] : Real(0);
          }
        });
  }
}

/// Rays of one segment cross blocks of air: their light is added to `sum`, and every array of `carried` is attenuated.
template <bool linear, class Real>
class AirSums {
 public:
  // @param sum null: no block emits.
  AirSums(const AirSource<linear, Real>& source, Real* sum, std::span<const CarriedRays<Real>> carried)
      : source_(source), sum_(sum), carried_(carried) {}

  void enter(std::size_t cell) { emission_ = source_.emission(cell, false); }
  [[gnu::always_inline]] void cross(std::size_t ray, int n) const {
    const Real emission = emission_;
    const Real absorbed = source_.absorbed();
    if (sum_ != nullptr) {
      Real* __restrict const sum = sum_ + ray;
      for_rays<Real>(
          n, [=](int i, bool active)
                 __attribute__((always_inline)) { sum[i] += active ? emission - absorbed * sum[i] : Real(0); });
    }
    for (const CarriedRays<Real>& slot : carried_) {
      Real* __restrict const light = slot.rays + ray;
      for_rays<Real>(
          n, [=](int i, bool active)
                 __attribute__((always_inline)) { light[i] -= active ? absorbed * light[i] : Real(0); });
    }
  }
  void leave() const {}

 private:
  AirSource<linear, Real> source_;
  Real* sum_;
  std::span<const CarriedRays<Real>> carried_;
  Real emission_ = 0;
};

}  // namespace cloudbow
