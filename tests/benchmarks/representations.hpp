// Shared by the benchmarks and tables of the sphere: the two test shapes and many functions at once.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "cloudbow/sphere/direction.hpp"

namespace cloudbow {

/// Henyey-Greenstein phase function about the unit vector `axis`, mean 1 over the sphere.
inline double henyey_greenstein(double g, const Direction& axis, const Direction& v) {
  return (1 - g * g) / std::pow(1 + g * g - 2 * g * axis.dot(v), 1.5);
}

inline std::vector<Direction> random_directions(int count, unsigned seed = 1) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<Direction> directions;
  for (int i = 0; i < count; ++i) {
    const double x = normal(generator), y = normal(generator), z = normal(generator);
    directions.push_back(Direction(x, y, z).normalized());
  }
  return directions;
}

/// `rows` rows of `functions` values of order 1, for timing: a cheap sequence, not the same twice.
inline std::vector<float> filled(std::size_t rows, std::size_t functions) {
  std::vector<float> values(rows * functions);
  unsigned state = 1;
  for (float& v : values) {
    state = state * 1664525u + 1013904223u;
    v = static_cast<float>(state >> 8) * 0x1p-24f;
  }
  return values;
}

}  // namespace cloudbow
