#include "cloudbow/sphere/sphere_mesh.hpp"

#include <algorithm>
#include <cassert>
#include <map>
#include <numbers>
#include <utility>

namespace cloudbow {
namespace {

std::vector<Direction> corners(Polyhedron polyhedron) {
  std::vector<Direction> corner;
  switch (polyhedron) {
    case Polyhedron::icosahedron:
      for (const double s : {1.0, -1.0}) {
        for (const double t : {std::numbers::phi, -std::numbers::phi}) {
          corner.insert(corner.end(), {{0, s, t}, {s, t, 0}, {t, 0, s}});
        }
      }
      break;
    case Polyhedron::octahedron:
      corner = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
      break;
    case Polyhedron::tetrahedron:
      corner = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
      break;
  }
  for (Direction& v : corner) v.normalize();
  return corner;
}

/// Dot products of neighbours lie above this, those of other corners below: .447 and -.447 for the icosahedron, 0 and
/// -1 for the octahedron, -1/3 (all are neighbours) for the tetrahedron.
double least_dot_of_neighbours(Polyhedron polyhedron) {
  return polyhedron == Polyhedron::icosahedron ? 0 : polyhedron == Polyhedron::octahedron ? -0.5 : -0.9;
}

SphereMesh make_polyhedron(Polyhedron polyhedron) {
  SphereMesh mesh{corners(polyhedron), {}};
  const auto& v = mesh.vertex;
  const int count = static_cast<int>(v.size());
  const double limit = least_dot_of_neighbours(polyhedron);
  const auto adjacent = [&](int i, int j) { return v[i].dot(v[j]) > limit; };
  for (int i = 0; i < count; ++i) {
    for (int j = i + 1; j < count; ++j) {
      for (int k = j + 1; k < count; ++k) {
        if (!adjacent(i, j) || !adjacent(j, k) || !adjacent(k, i)) continue;
        const bool outward = v[i].dot(v[j].cross(v[k])) > 0;
        mesh.triangle.push_back(outward ? std::array{i, j, k} : std::array{i, k, j});
      }
    }
  }
  return mesh;
}

SphereMesh subdivided(const SphereMesh& coarse) {
  SphereMesh fine{coarse.vertex, {}};
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

SphereMesh make_sphere_mesh(Polyhedron polyhedron, int subdivisions) {
  assert(subdivisions >= 0);
  SphereMesh mesh = make_polyhedron(polyhedron);
  for (int i = 0; i < subdivisions; ++i) mesh = subdivided(mesh);
  return mesh;
}

}  // namespace cloudbow
