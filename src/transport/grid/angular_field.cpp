#include "transport/grid/angular_field.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#ifdef __F16C__
#include <immintrin.h>
#endif

namespace cloudbow {
namespace {

constexpr float largest_half = 65504;
// Bits of a float that float16 lacks. They give the fraction of values rounded up, spread evenly over the indices.
constexpr int dropped = 13;
constexpr std::uint32_t dropped_bits = (1U << dropped) - 1;
constexpr std::uint32_t golden = 0x9E3779B9;  // 2^32 times the golden section

#ifdef __F16C__
constexpr std::size_t width = 8;
#endif

}  // namespace

void load_float16(const std::uint16_t* from, std::size_t n, float unit, float* to) {
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

void store_float16(const float* from, std::size_t n, float unit, std::uint32_t place, std::uint16_t* to) {
  const float inverse = 1 / unit;
  std::size_t i = 0;
#ifdef __F16C__
  const __m256 scale = _mm256_set1_ps(inverse);
  const __m256 most = _mm256_set1_ps(largest_half);
  const __m256i kept = _mm256_set1_epi32(static_cast<int>(~dropped_bits));
  const __m256i spread = _mm256_set1_epi32(static_cast<int>(golden));
  __m256i at = _mm256_add_epi32(_mm256_set1_epi32(static_cast<int>(place)), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
  for (; i + width <= n; i += width) {
    // If one of two numbers is NaN, the instruction takes the second.
    const __m256 value = _mm256_min_ps(most, _mm256_mul_ps(scale, _mm256_loadu_ps(from + i)));
    const __m256i part = _mm256_srli_epi32(_mm256_mullo_epi32(at, spread), 32 - dropped);
    const __m256i rounded = _mm256_and_si256(_mm256_add_epi32(_mm256_castps_si256(value), part), kept);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + i),
                     _mm256_cvtps_ph(_mm256_castsi256_ps(rounded), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
    at = _mm256_add_epi32(at, _mm256_set1_epi32(static_cast<int>(width)));
  }
#endif
  for (; i < n; ++i) {
    const auto value = std::bit_cast<std::uint32_t>(std::min(inverse * from[i], largest_half));
    const std::uint32_t part = ((place + static_cast<std::uint32_t>(i)) * golden) >> (32 - dropped);
    const auto rounded = std::bit_cast<float>((value + part) & ~dropped_bits);
    to[i] = Eigen::numext::bit_cast<std::uint16_t>(static_cast<Eigen::half>(rounded));
  }
}

}  // namespace cloudbow
