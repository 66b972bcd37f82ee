#include "cloudbow/sphere/interpolation_weights.hpp"

#include <cmath>

namespace cloudbow {
namespace {

double triple_product(const Direction& a, const Direction& b, const Direction& c) { return a.dot(b.cross(c)); }

std::array<double, 3> normalised(std::array<double, 3> weight) {
  const double whole = weight[0] + weight[1] + weight[2];
  double kept = 0;
  for (double& w : weight) {
    if (w < 1e-13 * whole) w = 0;  // rounding: a direction that is meant to be a vertex or on a side is one
    kept += w;
  }
  for (double& w : weight) w /= kept;
  return weight;
}

}  // namespace

double spherical_triangle_area(const Direction& a, const Direction& b, const Direction& c) {
  return 2 * std::atan2(triple_product(a, b, c), 1 + a.dot(b) + b.dot(c) + c.dot(a));
}

std::array<double, 3> spherical_area_weights(const Direction& p, const Direction& a, const Direction& b,
                                             const Direction& c) {
  return normalised(
      {spherical_triangle_area(p, b, c), spherical_triangle_area(p, c, a), spherical_triangle_area(p, a, b)});
}

std::array<double, 3> planar_weights(const Direction& p, const Direction& a, const Direction& b, const Direction& c) {
  return normalised({triple_product(p, b, c), triple_product(p, c, a), triple_product(p, a, b)});
}

}  // namespace cloudbow
