// Meshes of the sphere. Truth: Euler's formula, the area of the sphere, and the orientation of the triangles.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "cloudbow/sphere/sphere_mesh.hpp"

namespace cloudbow {
namespace {

class SphereMeshTest : public testing::TestWithParam<std::pair<Polyhedron, std::size_t>> {};

/// Solid angle of a spherical triangle (van Oosterom and Strackee 1983).
double solid_angle(const Direction& a, const Direction& b, const Direction& c) {
  return 2 * std::atan2(a.dot(b.cross(c)), 1 + a.dot(b) + b.dot(c) + c.dot(a));
}

TEST_P(SphereMeshTest, IsAClosedSurfaceOfUnitVectors) {
  const auto [polyhedron, faces] = GetParam();
  for (int n = 0; n < 4; ++n) {
    const SphereMesh mesh = make_sphere_mesh(polyhedron, n);
    EXPECT_EQ(mesh.triangle.size(), faces << (2 * n));
    std::map<std::pair<int, int>, int> edges;
    double area = 0;
    for (const auto& t : mesh.triangle) {
      const double angle = solid_angle(mesh.vertex[t[0]], mesh.vertex[t[1]], mesh.vertex[t[2]]);
      EXPECT_GT(angle, 0) << "counter-clockwise from outside";
      area += angle;
      for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    }
    EXPECT_NEAR(area, 4 * std::numbers::pi, 1e-12);
    for (const auto& [edge, count] : edges) {
      EXPECT_EQ(count, 1);
      EXPECT_EQ(edges.count({edge.second, edge.first}), 1U) << "the neighbour runs along it the other way";
    }
    EXPECT_EQ(mesh.vertex.size() + mesh.triangle.size(), edges.size() / 2 + 2) << "Euler's formula";
    for (const Direction& vertex : mesh.vertex) EXPECT_NEAR(vertex.norm(), 1, 1e-15);
  }
}

TEST_P(SphereMeshTest, VerticesOfTheCoarserMeshComeFirst) {
  const SphereMesh coarse = make_sphere_mesh(GetParam().first, 1), fine = make_sphere_mesh(GetParam().first, 2);
  for (std::size_t n = 0; n < coarse.vertex.size(); ++n) EXPECT_EQ(fine.vertex[n], coarse.vertex[n]);
}

INSTANTIATE_TEST_SUITE_P(Polyhedra, SphereMeshTest,
                         testing::Values(std::pair(Polyhedron::icosahedron, std::size_t{20}),
                                         std::pair(Polyhedron::octahedron, std::size_t{8}),
                                         std::pair(Polyhedron::tetrahedron, std::size_t{4})));

}  // namespace
}  // namespace cloudbow
