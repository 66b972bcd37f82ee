// Directions for tests.
#pragma once

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "cloudbow/sphere/direction.hpp"

namespace cloudbow {

/// Evenly distributed, the same in every run.
inline std::vector<Direction> random_directions(int count) {
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  std::vector<Direction> directions;
  for (int i = 0; i < count; ++i) {
    const double x = normal(generator), y = normal(generator), z = normal(generator);
    directions.push_back(Direction(x, y, z).normalized());
  }
  return directions;
}

/// A rotation by `angle` [rad] about `axis`, of any length.
inline Eigen::Matrix3d turn(double angle, const Direction& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

}  // namespace cloudbow
