// Rays in air (docs/theory.md, "Rays in air"): air between clouds acts on all rays of a direction alike. It changes two
// numbers that belong to their array, and no ray.
#pragma once

#include <cstddef>

#include "transport/grid/lanes.hpp"

namespace cloudbow {

/// The radiances of an array of rays are scale * stored + offset.
struct StoredRays {
  double scale = 1;
  double offset = 0;

  /// @param absorbed share of the entering light that does not leave the air; @param emission light that the air adds.
  void cross_air(double absorbed, double emission) {
    scale -= absorbed * scale;
    offset += emission - absorbed * offset;
  }
  /// Makes the n stored values the radiances.
  template <class Real>
  void write(Real* __restrict rays, std::size_t n) {
    if (scale == 1 && offset == 0) return;
    const Real by = static_cast<Real>(scale), more = static_cast<Real>(offset);
#pragma omp simd
    for (std::size_t i = 0; i < n; ++i) rays[i] = by * rays[i] + more;
    *this = {};
  }
};

/// How a kernel reads and writes rays that are stored as they are.
struct PlainRays {
  template <class Value>
  [[gnu::always_inline]] static const Value& radiance(const Value& stored) {
    return stored;
  }
  template <class Value>
  [[gnu::always_inline]] static const Value& stored(const Value& radiance) {
    return radiance;
  }
  template <class Mask, class Value>
  [[gnu::always_inline]] static void note(const Mask&, const Value&, const Value&) {}
};

/// The same in a segment whose air changes how rays are stored. It sums the radiances that enter and leave cells.
template <class Real>
class RaysInAir {
 public:
  using Value = typename Pack<Real>::Value;

  RaysInAir(const StoredRays& before, const StoredRays& after)
      : scale_(static_cast<Real>(before.scale)),
        offset_(static_cast<Real>(before.offset)),
        inverse_(static_cast<Real>(1 / after.scale)),
        offset_after_(static_cast<Real>(after.offset)) {}

  [[gnu::always_inline]] Value radiance(const Value& stored) const { return scale_ * stored + offset_; }
  [[gnu::always_inline]] Value stored(const Value& radiance) const { return inverse_ * (radiance - offset_after_); }
  /// The cells that a kernel has crossed.
  [[gnu::always_inline]] void note(const typename Pack<Real>::Mask& active, const Value& in, const Value& out) {
    in_ += Pack<Real>::masked(active, in);
    out_ += Pack<Real>::masked(active, out);
  }
  /// Ends a sum of at most some tens of terms: longer ones would lose digits in float.
  void finish_sums() {
    entered += static_cast<double>(Pack<Real>::sum(in_));
    left += static_cast<double>(Pack<Real>::sum(out_));
    in_ = Value{};
    out_ = Value{};
  }

  double entered = 0;  ///< sum of the radiances that entered cells, up to finish_sums()
  double left = 0;     ///< the same of those that left

 private:
  Real scale_, offset_;
  Real inverse_, offset_after_;
  Value in_{}, out_{};
};

}  // namespace cloudbow
