// Random numbers and distributions that are the same with every compiler and library.
#pragma once

#include <cstdint>

namespace cloudbow {

/// One step of SplitMix64 (Steele, Lea & Flood 2014, doi 10.1145/2660193.2660195): also a hash of its argument.
inline std::uint64_t split_mix(std::uint64_t state) {
  state += 0x9e3779b97f4a7c15U;
  state = (state ^ (state >> 30U)) * 0xbf58476d1ce4e5b9U;
  state = (state ^ (state >> 27U)) * 0x94d049bb133111ebU;
  return state ^ (state >> 31U);
}

class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : state_(split_mix(seed) ^ split_mix(~stream)) {}

  /// 0 <= u < 1, 53 bits.
  double uniform() { return static_cast<double>(next() >> 11U) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Mean 0, variance 1: the sum of 12 uniform numbers (Irwin-Hall), bounded by 6, in exact arithmetic.
  double normal() {
    double sum = -6;
    for (int n = 0; n < 12; ++n) sum += uniform();
    return sum;
  }

 private:
  std::uint64_t next() {
    const std::uint64_t number = split_mix(state_);
    state_ += 0x9e3779b97f4a7c15U;
    return number;
  }

  std::uint64_t state_;
};

}  // namespace cloudbow
