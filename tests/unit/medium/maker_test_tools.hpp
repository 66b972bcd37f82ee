// Functions that the tests of cloud makers share.
#pragma once

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <vector>

#include "cloud_test_tools.hpp"
#include "cloudbow/medium/cloud_makers.hpp"

namespace cloudbow {

inline constexpr double single_precision = 1e-6;   // relative rounding of values stored in 32 bits
inline constexpr double value_rounding = 0x1p-11;  // relative, of random clouds

inline CloudMakerOptions options(const std::string& kind, std::array<int, 3> cells,
                                 std::array<double, 3> voxel_size_m = {50, 50, 25}) {
  CloudMakerOptions result;
  result.kind = kind;
  result.cells = cells;
  result.voxel_size_m = voxel_size_m;
  return result;
}

inline double cover(const std::vector<double>& depths) {
  const auto cloudy = std::count_if(depths.begin(), depths.end(), [](double depth) { return depth > 0; });
  return static_cast<double>(cloudy) / static_cast<double>(depths.size());
}

inline double cloudy_mean(const std::vector<double>& depths) {
  return std::accumulate(depths.begin(), depths.end(), 0.0) / (cover(depths) * static_cast<double>(depths.size()));
}

}  // namespace cloudbow
