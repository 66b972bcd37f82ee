#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cloudbow/core/error.hpp"
#include "cloudbow/sphere/control_points.hpp"
#include "directions.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

double least_side(const ControlPoints& points, const std::array<int, 3>& triangle, const Direction& p) {
  const auto v = points.directions();
  const auto side = [&](int i, int j) { return p.dot(v[i].cross(v[j])); };
  return std::min({side(triangle[0], triangle[1]), side(triangle[1], triangle[2]), side(triangle[2], triangle[0])});
}

/// Poles, axes, vertices, points on edges, each also displaced by 1e-15 to 1e-7: faults of point location appear at
/// these.
std::vector<Direction> awkward_directions(const ControlPoints& points) {
  std::vector<Direction> exact = {{0, 0, 1},
                                  {0, 0, -1},
                                  {1, 0, 0},
                                  {-1, 0, 0},
                                  {0, 1, 0},
                                  {0, -1, 0},
                                  {-1, -0.0, 0},
                                  {-1, -0.0, -0.0},
                                  Direction(1, 1, 0).normalized(),
                                  Direction(-1, 0, 1).normalized()};
  for (const auto& [a, b, c] : points.triangles()) {
    const auto v = points.directions();
    exact.push_back(v[a]);
    exact.push_back((v[a] + v[b]).normalized());
    exact.push_back((0.9 * v[b] + 0.1 * v[c]).normalized());
  }
  std::vector<Direction> all = exact;
  for (const double shift : {1e-15, 1e-12, 1e-9, 1e-7}) {
    for (const Direction& d : exact) {
      all.push_back((d + shift * Direction(0.3, -0.8, 0.5)).normalized());
      all.push_back((d - shift * Direction(0.3, -0.8, 0.5)).normalized());
    }
  }
  return all;
}

class EveryOrder : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(ControlPoints, EveryOrder, testing::Values(12, 42, 162, 642));

TEST_P(EveryOrder, CoversTheSphereOnce) {
  const ControlPoints points(GetParam());
  ASSERT_EQ(points.size(), GetParam());
  EXPECT_EQ(static_cast<int>(points.triangles().size()), 2 * points.size() - 4);  // Euler
  double area = 0;
  for (const auto& [a, b, c] : points.triangles()) {
    const double piece =
        spherical_triangle_area(points.directions()[a], points.directions()[b], points.directions()[c]);
    EXPECT_GT(piece, 0);  // counter-clockwise seen from outside
    area += piece;
  }
  EXPECT_NEAR(area, 4 * pi, 1e-12);  // 1280 rounded areas
}

TEST_P(EveryOrder, CoordinatePlanesAreMirrorsToTheBit) {
  const ControlPoints points(GetParam());
  for (const Direction& v : points.directions()) {
    for (int axis = 0; axis < 3; ++axis) {
      Direction mirrored = v;
      mirrored[axis] = -mirrored[axis];
      EXPECT_TRUE(std::any_of(points.directions().begin(), points.directions().end(),
                              [&](const Direction& u) { return u == mirrored; }));
    }
  }
}

TEST_P(EveryOrder, LocatesEveryDirectionInTheTriangleThatHoldsIt) {
  const ControlPoints points(GetParam());
  std::vector<Direction> directions = awkward_directions(points);
  const auto random = random_directions(2000);
  directions.insert(directions.end(), random.begin(), random.end());
  for (const Direction& d : directions) {
    const Stencil s = points.stencil(d);
    // Rounding of a cross product of unit vectors is 1e-16; a wrong triangle is off by its edge, .1 or more, or by the
    // shift.
    EXPECT_GE(least_side(points, s.index, d), -1e-15) << d.transpose();
    EXPECT_NEAR(s.weight[0] + s.weight[1] + s.weight[2], 1, 1e-15);
    EXPECT_GE(*std::min_element(s.weight.begin(), s.weight.end()), 0);
  }
}

struct Subdivided {
  Polyhedron polyhedron;
  int subdivisions, vertices;
};
void PrintTo(const Subdivided& s, std::ostream* out) { *out << s.vertices << " vertices"; }

class EveryPolyhedron : public testing::TestWithParam<Subdivided> {
 protected:
  const ControlPoints points_{GetParam().polyhedron, GetParam().subdivisions};
};
INSTANTIATE_TEST_SUITE_P(
    ControlPoints, EveryPolyhedron,
    testing::Values(Subdivided{Polyhedron::tetrahedron, 0, 4}, Subdivided{Polyhedron::tetrahedron, 3, 130},
                    Subdivided{Polyhedron::octahedron, 0, 6}, Subdivided{Polyhedron::octahedron, 2, 66},
                    Subdivided{Polyhedron::octahedron, 3, 258}, Subdivided{Polyhedron::icosahedron, 0, 12},
                    Subdivided{Polyhedron::icosahedron, 2, 162}, Subdivided{Polyhedron::icosahedron, 4, 2562}));

TEST_P(EveryPolyhedron, CoversTheSphereOnce) {
  ASSERT_EQ(points_.size(), GetParam().vertices);
  EXPECT_EQ(static_cast<int>(points_.triangles().size()), 2 * points_.size() - 4);  // Euler
  // Summed by Neumaier's method: the rest is the rounding of the areas themselves.
  double area = 0, lost = 0;
  for (const auto& [a, b, c] : points_.triangles()) {
    const auto v = points_.directions();
    const double piece = spherical_triangle_area(v[a], v[b], v[c]);
    EXPECT_GT(piece, 0);
    const double sum = area + piece;
    lost += (area - sum) + piece;
    area = sum;
  }
  EXPECT_NEAR((area + lost) / (4 * pi), 1, 1e-13);
}

TEST_P(EveryPolyhedron, LocatesWhatASearchOfAllTrianglesFinds) {
  std::vector<Direction> directions = awkward_directions(points_);
  if (directions.size() > 2000) directions.resize(2000);
  const auto random = random_directions(3000);
  directions.insert(directions.end(), random.begin(), random.end());
  for (const Direction& d : directions) {
    double best = -1;
    for (const auto& triangle : points_.triangles()) best = std::max(best, least_side(points_, triangle, d));
    // On a side and at a vertex several triangles are right: they hold the direction equally well, up to rounding.
    EXPECT_NEAR(least_side(points_, points_.triangles()[points_.triangle_at(d)], d), best, 1e-15) << d.transpose();
  }
}

TEST_P(EveryPolyhedron, WeightsOfEitherKindArePositiveSumToOneAndAreOneAtTheVertices) {
  for (const Interpolation kind : {Interpolation::spherical_area, Interpolation::planar}) {
    for (const Direction& d : random_directions(500)) {
      const Stencil s = points_.stencil(d, kind);
      EXPECT_NEAR(s.weight[0] + s.weight[1] + s.weight[2], 1, 1e-15);
      EXPECT_GE(*std::min_element(s.weight.begin(), s.weight.end()), 0);
    }
    for (int m = 0; m < points_.size(); ++m) {
      const Stencil s = points_.stencil(points_.directions()[m], kind);
      const auto largest = std::max_element(s.weight.begin(), s.weight.end()) - s.weight.begin();
      EXPECT_EQ(s.index[largest], m);
      EXPECT_NEAR(s.weight[largest], 1, 1e-14);
    }
  }
}

TEST(ControlPoints, RejectsOtherSubdivisions) {
  for (const int subdivisions : {-1, 7}) EXPECT_THROW(ControlPoints(Polyhedron::octahedron, subdivisions), InputError);
}

TEST_P(EveryOrder, ReturnsTheStoredValueAtAControlPoint) {
  const ControlPoints points(GetParam(), Eigen::AngleAxisd(0.7, Direction(1, 2, 3).normalized()).toRotationMatrix());
  for (int m = 0; m < points.size(); ++m) {
    const Stencil s = points.stencil(points.directions()[m]);
    const auto largest = std::max_element(s.weight.begin(), s.weight.end()) - s.weight.begin();
    EXPECT_EQ(s.index[largest], m);
    EXPECT_NEAR(s.weight[largest], 1, 1e-14);
  }
}

TEST(ControlPoints, WeightsAreTheAreasOfTheOppositeTriangles) {
  const ControlPoints points(42);
  for (const Direction& p : random_directions(200)) {
    const auto [index, weight] = points.stencil(p);
    const auto v = [&](int k) { return points.directions()[index[k]]; };
    const double whole = spherical_triangle_area(v(0), v(1), v(2));
    EXPECT_NEAR(weight[0], spherical_triangle_area(p, v(1), v(2)) / whole, 1e-13);
    EXPECT_NEAR(weight[1], spherical_triangle_area(v(0), p, v(2)) / whole, 1e-13);
    EXPECT_NEAR(weight[2], spherical_triangle_area(v(0), v(1), p) / whole, 1e-13);
  }
}

TEST(ControlPoints, CentreOfAnEquilateralTriangleHasThreeEqualWeights) {
  const ControlPoints points(12);
  for (const auto& [a, b, c] : points.triangles()) {
    const auto v = points.directions();
    for (const double w : points.stencil((v[a] + v[b] + v[c]).normalized()).weight) EXPECT_NEAR(w, 1.0 / 3, 1e-14);
  }
}

TEST(ControlPoints, NeighbouringTrianglesNearlyAgreeOnTheirCommonSide) {
  // The two weights on a side are areas of triangles with the apex of either neighbour: equal on the plane, on the
  // sphere their difference goes with the square of the side (.32 and .16 rad).
  const auto worst_jump = [](const ControlPoints& points) {
    double worst = 0;
    for (const auto& [a, b, c] : points.triangles()) {
      const Direction on_edge = (0.75 * points.directions()[a] + 0.25 * points.directions()[b]).normalized();
      const Direction across = 1e-9 * (points.directions()[c] - on_edge);
      const auto weight_of_a = [&, vertex = a](const Direction& d) {
        const auto [index, weight] = points.stencil(d);
        return weight[std::find(index.begin(), index.end(), vertex) - index.begin()];
      };
      worst = std::max(
          worst, std::abs(weight_of_a((on_edge + across).normalized()) - weight_of_a((on_edge - across).normalized())));
    }
    return worst;
  };
  const double coarse = worst_jump(ControlPoints(162)), fine = worst_jump(ControlPoints(642));
  EXPECT_LT(coarse, 0.32 * 0.32 / 16);
  EXPECT_LT(fine, 0.16 * 0.16 / 16);
}

TEST(ControlPoints, TurnedFrameGivesTheSameStencil) {
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, Direction(-1, 2, 0.5).normalized()).toRotationMatrix();
  const ControlPoints plain(162), turned(162, rotation);
  for (const Direction& d : random_directions(500)) {
    const Stencil a = plain.stencil(d), b = turned.stencil(rotation * d);
    EXPECT_EQ(a.index, b.index);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(a.weight[k], b.weight[k], 1e-13);  // rounding 1e-16 over an edge of .15
  }
}

TEST(ControlPoints, RejectsOtherCounts) {
  EXPECT_THROW(
      try { ControlPoints(100); } catch (const InputError& e) {
        EXPECT_THAT(e.what(), testing::AllOf(testing::HasSubstr("100"), testing::HasSubstr("12, 42, 162 or 642")));
        throw;
      },
      InputError);
}

TEST(SphericalTriangleArea, IsAnEighthOfTheSphereForAnOctant) {
  const Direction x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  EXPECT_DOUBLE_EQ(spherical_triangle_area(x, y, z), pi / 2);
  EXPECT_DOUBLE_EQ(spherical_triangle_area(x, z, y), -pi / 2);
}

TEST(SphericalTriangleArea, IsThePlaneAreaForASmallTriangle) {
  const double h = 1e-5;
  const Direction a(0, 0, 1), b = Direction(h, 0, 1).normalized(), c = Direction(0, h, 1).normalized();
  EXPECT_NEAR(spherical_triangle_area(a, b, c) / (h * h / 2), 1, 1e-9);  // curvature: order h^2
}

}  // namespace
}  // namespace cloudbow
