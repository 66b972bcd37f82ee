#include "cloudbow/sphere/icosphere.hpp"

#include <Eigen/Dense>

namespace cloudbow {

Icosphere make_icosphere(int subdivisions) { return make_sphere_mesh(Polyhedron::icosahedron, subdivisions); }

std::vector<Eigen::Matrix3d> icosahedral_group() {
  const Icosphere sphere = make_icosphere(0);
  const auto columns = [&](const std::array<int, 3>& t) {
    Eigen::Matrix3d m;
    m << sphere.vertex[t[0]], sphere.vertex[t[1]], sphere.vertex[t[2]];
    return m;
  };
  // A map is determined by the image of one triangle: any of 20, its corners in any of 6 orders.
  const Eigen::Matrix3d from_first = columns(sphere.triangle.front()).inverse();
  std::vector<Eigen::Matrix3d> group;
  for (const auto& triangle : sphere.triangle) {
    constexpr int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (const auto& o : orders)
      group.push_back(columns({triangle[o[0]], triangle[o[1]], triangle[o[2]]}) * from_first);
  }
  return group;
}

}  // namespace cloudbow
