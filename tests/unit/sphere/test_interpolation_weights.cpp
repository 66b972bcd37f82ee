#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cloudbow/sphere/control_points.hpp"
#include "cloudbow/sphere/interpolation_weights.hpp"
#include "directions.hpp"

namespace cloudbow {
namespace {

/// Largest error of the interpolated function v itself, which holds every linear function.
double worst_linear_error(int subdivisions, Interpolation kind) {
  const ControlPoints points(Polyhedron::icosahedron, subdivisions);
  double worst = 0;
  for (const Direction& d : random_directions(4000)) {
    const auto [index, weight] = points.stencil(d, kind);
    Direction sum = Direction::Zero();
    for (int k = 0; k < 3; ++k) sum += weight[k] * points.directions()[index[k]];
    worst = std::max(worst, (sum - d).norm());
  }
  return worst;
}

class EitherKind : public testing::TestWithParam<Interpolation> {};
INSTANTIATE_TEST_SUITE_P(InterpolationWeights, EitherKind,
                         testing::Values(Interpolation::spherical_area, Interpolation::planar));

TEST_P(EitherKind, ReproducesLinearFunctionsToTheSquareOfTheSide) {
  // Sides are halved from one set to the next. 4000 directions find the largest error to a few per cent.
  double coarse = worst_linear_error(1, GetParam());
  for (int subdivisions = 2; subdivisions <= 4; ++subdivisions) {
    const double fine = worst_linear_error(subdivisions, GetParam());
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.15);
    coarse = fine;
  }
}

TEST(PlanarWeights, AreTheBarycentricCoordinatesOfThePlanePoint) {
  const Direction a = Direction(1, 0.2, 0).normalized(), b = Direction(0.1, 1, 0.3).normalized(),
                  c = Direction(-0.2, 0, 1).normalized();
  const Direction p = (0.2 * a + 0.3 * b + 0.5 * c).normalized();
  const auto weight = planar_weights(p, a, b, c);
  EXPECT_NEAR(weight[0], 0.2, 1e-15);
  EXPECT_NEAR(weight[1], 0.3, 1e-15);
  EXPECT_NEAR(weight[2], 0.5, 1e-15);
}

TEST(PlanarWeights, OnASideDependOnItsEndsOnly) {
  const Direction a(1, 0, 0), b = Direction(0.8, 0.6, 0), left = Direction(0.7, 0.3, 0.4).normalized(),
                              right = Direction(0.8, 0.1, -0.9).normalized();
  const Direction p = (a + 2 * b).normalized();
  const auto l = planar_weights(p, a, b, left), r = planar_weights(p, b, a, right);
  EXPECT_NEAR(l[0], r[1], 1e-15);
  EXPECT_NEAR(l[1], r[0], 1e-15);
  EXPECT_EQ(l[2], 0);
  EXPECT_EQ(r[2], 0);
}

TEST(SphericalAreaWeights, JumpAcrossASideWithTheSquareOfTheSide) {
  // The side of 162 points is .32 rad at most, that of 642 half as long: the jump must fall fourfold.
  const auto worst_jump = [](int subdivisions) {
    const ControlPoints points(Polyhedron::icosahedron, subdivisions);
    const auto v = points.directions();
    double worst = 0;
    for (const auto& t : points.triangles()) {
      for (const auto& u : points.triangles()) {
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) {
            if (t[i] != u[(j + 1) % 3] || t[(i + 1) % 3] != u[j]) continue;
            const Direction p = (0.75 * v[t[i]] + 0.25 * v[u[j]]).normalized();
            const auto here = spherical_area_weights(p, v[t[i]], v[u[j]], v[t[(i + 2) % 3]]);
            const auto there = spherical_area_weights(p, v[u[j]], v[t[i]], v[u[(j + 2) % 3]]);
            worst = std::max(worst, std::abs(here[0] - there[1]));
          }
        }
      }
    }
    return worst;
  };
  const double coarse = worst_jump(2), fine = worst_jump(3);
  EXPECT_GT(coarse, 1e-4);
  EXPECT_LT(coarse, 3e-3);
  EXPECT_LT(fine, coarse / 3);
}

}  // namespace
}  // namespace cloudbow
