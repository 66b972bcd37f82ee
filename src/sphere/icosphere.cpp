#include "cloudbow/sphere/icosphere.hpp"

#include <algorithm>
#include <map>
#include <numbers>
#include <utility>

namespace cloudbow {
namespace {

Icosphere make_icosahedron() {
  Icosphere sphere;
  for (const double s : {1.0, -1.0}) {
    for (const double t : {std::numbers::phi, -std::numbers::phi}) {
      for (const Direction& v : {Direction(0, s, t), Direction(s, t, 0), Direction(t, 0, s)}) {
        sphere.vertex.push_back(v.normalized());
      }
    }
  }
  const auto& v = sphere.vertex;
  // Neighbours have dot product 1/sqrt(5) = .447; the next nearest pairs have -.447.
  const auto adjacent = [&](int i, int j) { return v[i].dot(v[j]) > 0; };
  for (int i = 0; i < 12; ++i) {
    for (int j = i + 1; j < 12; ++j) {
      for (int k = j + 1; k < 12; ++k) {
        if (!adjacent(i, j) || !adjacent(j, k) || !adjacent(k, i)) continue;
        const bool outward = v[i].dot(v[j].cross(v[k])) > 0;
        sphere.triangle.push_back(outward ? std::array{i, j, k} : std::array{i, k, j});
      }
    }
  }
  return sphere;
}

Icosphere subdivided(const Icosphere& coarse) {
  Icosphere fine{coarse.vertex, {}};
  std::map<std::pair<int, int>, int> midpoint_of;
  const auto midpoint = [&](int a, int b) {
    const auto [at, is_new] = midpoint_of.try_emplace(std::minmax(a, b), static_cast<int>(fine.vertex.size()));
    if (is_new) fine.vertex.push_back((coarse.vertex[a] + coarse.vertex[b]).normalized());
    return at->second;
  };
  for (const auto& [a, b, c] : coarse.triangle) {
    const int ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
    fine.triangle.insert(fine.triangle.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  return fine;
}

}  // namespace

Icosphere make_icosphere(int subdivisions) {
  Icosphere sphere = make_icosahedron();
  for (int i = 0; i < subdivisions; ++i) sphere = subdivided(sphere);
  return sphere;
}

std::vector<Eigen::Matrix3d> icosahedral_group() {
  const Icosphere sphere = make_icosahedron();
  const auto columns = [&](const std::array<int, 3>& t) {
    Eigen::Matrix3d m;
    m << sphere.vertex[t[0]], sphere.vertex[t[1]], sphere.vertex[t[2]];
    return m;
  };
  // A map is known by where it takes one triangle: any of 20, its corners in any of 6 orders.
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
