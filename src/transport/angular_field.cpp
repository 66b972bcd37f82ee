#include "cloudbow/transport/angular_field.hpp"

#include <Eigen/Core>
#include <algorithm>
#ifdef __F16C__
#include <immintrin.h>
#endif

namespace cloudbow {
namespace {

constexpr float largest_half = 65504;

#ifdef __F16C__
constexpr std::size_t width = 8;
#endif

}  // namespace

void load_halves(const std::uint16_t* from, std::size_t n, float unit, float* to) {
  std::size_t i = 0;
#ifdef __F16C__
  const __m256 scale = _mm256_set1_ps(unit);
  for (; i + width <= n; i += width) {
    const __m128i packed = _mm_loadu_si128(reinterpret_cast<const __m128i*>(from + i));
    _mm256_storeu_ps(to + i, _mm256_mul_ps(scale, _mm256_cvtph_ps(packed)));
  }
#endif
  for (; i < n; ++i) to[i] = unit * static_cast<float>(Eigen::numext::bit_cast<Eigen::half>(from[i]));
}

void store_halves(const float* from, std::size_t n, float unit, std::uint16_t* to) {
  const float inverse = 1 / unit;
  std::size_t i = 0;
#ifdef __F16C__
  const __m256 scale = _mm256_set1_ps(inverse);
  const __m256 most = _mm256_set1_ps(largest_half);
  for (; i + width <= n; i += width) {
    const __m256 value = _mm256_min_ps(_mm256_mul_ps(scale, _mm256_loadu_ps(from + i)), most);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + i),
                     _mm256_cvtps_ph(value, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
  }
#endif
  for (; i < n; ++i)
    to[i] = Eigen::numext::bit_cast<std::uint16_t>(static_cast<Eigen::half>(std::min(inverse * from[i], largest_half)));
}

}  // namespace cloudbow
