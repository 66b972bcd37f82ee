// Eight values that go through a kernel together, in the compiler's own vector types (of GCC and Clang): loops over
// masked runs of cells do not vectorise dependably.
#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>
#ifdef __AVX__
#include <immintrin.h>
#endif

// Without AVX, compilers warn of functions that take or return eight values. All of these are inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace cloudbow {

/// Numbers of values: those that a kernel takes at a time, and those readable behind the end of its arrays.
inline constexpr int lanes = 8;
inline constexpr std::size_t lane_padding = 8;

template <class Real>
struct LanesOf {
  typedef Real type __attribute__((vector_size(lanes * sizeof(Real))));
};
template <class Real>
using Lanes = typename LanesOf<Real>::type;
using LaneMask = Lanes<std::int32_t>;

template <class Real>
[[gnu::always_inline]] inline void load_lanes(const Real* from, Lanes<Real>& v) {
  std::memcpy(&v, from, sizeof v);
}
template <class Real>
[[gnu::always_inline]] inline void store_lanes(const Lanes<Real>& v, Real* to) {
  std::memcpy(to, &v, sizeof v);
}

/// Stores the lanes whose mask is true, and leaves the others unchanged.
[[gnu::always_inline]] inline void store_masked(const LaneMask& mask, const Lanes<float>& v, float* to) {
#ifdef __AVX__
  _mm256_maskstore_ps(to, (__m256i)mask, v);
#else
  Lanes<float> old;
  load_lanes(to, old);
  store_lanes<float>(mask ? v : old, to);
#endif
}

/// True in the first n lanes.
[[gnu::always_inline]] inline LaneMask first_lanes(int n) {
  constexpr LaneMask place = {0, 1, 2, 3, 4, 5, 6, 7};
  return place < n;
}

/// Cells that a kernel takes at a time, so that it is written once for both precisions: `lanes` in float, one in
/// double.
template <class Real>
struct Pack {
  using Value = Real;
  using Mask = bool;
  static constexpr int size = 1;

  /// Steps of i += 1 in which a kernel takes `count` <= lanes cells.
  static int steps(int count) { return count; }
  static Mask first(int) { return true; }
  [[gnu::always_inline]] static Value load(const Real* from) { return *from; }
  [[gnu::always_inline]] static void store(Mask, const Value& v, Real* to) { *to = v; }
  [[gnu::always_inline]] static void store_all(const Value& v, Real* to) { *to = v; }
  /// The values of the first cells, 0 in the others.
  [[gnu::always_inline]] static Value masked(Mask, const Value& v) { return v; }
  /// Over the cells, in their order.
  [[gnu::always_inline]] static Real sum(const Value& v) { return v; }
};
template <>
struct Pack<float> {
  using Value = Lanes<float>;
  using Mask = LaneMask;
  static constexpr int size = lanes;

  static int steps(int) { return 1; }
  [[gnu::always_inline]] static Mask first(int count) { return first_lanes(count); }
  /// Reads up to lane_padding values behind the last of the cells.
  [[gnu::always_inline]] static Value load(const float* from) {
    Value v;
    load_lanes(from, v);
    return v;
  }
  [[gnu::always_inline]] static void store(const Mask& mask, const Value& v, float* to) { store_masked(mask, v, to); }
  [[gnu::always_inline]] static void store_all(const Value& v, float* to) { store_lanes<float>(v, to); }
  [[gnu::always_inline]] static Value masked(const Mask& mask, const Value& v) { return mask ? v : Value{}; }
  [[gnu::always_inline]] static float sum(const Value& v) {
    float total = 0;
    for (int i = 0; i < lanes; ++i) total += v[i];
    return total;
  }
};

}  // namespace cloudbow
