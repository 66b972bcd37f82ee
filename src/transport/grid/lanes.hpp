// Eight values that go through a kernel together, in the compiler's own vector types (of GCC and Clang): loops over
// masked runs of cells do not vectorise dependably.
#pragma once

#include <cstdint>
#include <cstring>
#ifdef __AVX__
#include <immintrin.h>
#endif

namespace cloudbow {

/// Values that a kernel takes at a time, and what it may read behind the end of its arrays.
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

/// Stores the lanes whose mask is true, and leaves what is beside them untouched.
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

}  // namespace cloudbow
