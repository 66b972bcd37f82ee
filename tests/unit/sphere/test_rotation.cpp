#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "cloudbow/sphere/icosphere.hpp"
#include "cloudbow/sphere/rotation.hpp"
#include "cloudbow/sphere/spherical_function.hpp"
#include "directions.hpp"

namespace cloudbow {
namespace {

double peak(const Direction& v) { return std::exp(3 * v.dot(Direction(0.6, 0, 0.8))); }

std::vector<double> values_of(const ControlPoints& points, const Eigen::Matrix3d& rotation) {
  std::vector<double> values;
  for (const Direction& v : points.directions()) values.push_back(peak(rotation.transpose() * v));
  return values;
}

double worst_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

const Eigen::Matrix3d frame = turn(1.1, {-1, 2, 0.5});

TEST(Rotation, OfTheIcosahedralGroupIsExactByEveryMethod) {
  for (const int count : {12, 42, 162}) {
    const ControlPoints points(count, frame);
    const auto values = values_of(points, Eigen::Matrix3d::Identity());
    int rotations = 0;
    for (const auto& g : icosahedral_group()) {
      if (g.determinant() < 0) continue;
      ++rotations;
      const Eigen::Matrix3d rotation = frame * g * frame.transpose();
      const auto expected = values_of(points, rotation);
      std::vector<double> rotated(values.size());

      const auto permutation = exact_permutation(points, rotation);
      ASSERT_TRUE(permutation);
      permute<double>(*permutation, values, rotated);
      EXPECT_LT(worst_difference(rotated, expected), 1e-13);  // rounding of the expected values, up to 20
      if (count < 162) {
        EXPECT_EQ(nearest_permutation(points, rotation, Matching::best_first), *permutation);
        EXPECT_EQ(nearest_permutation(points, rotation, Matching::outward), *permutation);
        EXPECT_EQ(nearest_permutation(points, rotation, Matching::least_squares), *permutation);
      }
      for (const Interpolation kind : {Interpolation::spherical_area, Interpolation::planar}) {
        reweight<double>(reweighting(points, rotation, kind), values, rotated);
        EXPECT_LT(worst_difference(rotated, expected), 1e-12);
      }
    }
    EXPECT_EQ(rotations, 60);
  }
}

TEST(Rotation, OutsideTheGroupIsNoExactPermutation) {
  EXPECT_FALSE(exact_permutation(ControlPoints(162), turn(0.1, {0, 0, 1})));
  EXPECT_FALSE(exact_permutation(ControlPoints(162), turn(1e-6, {1, 2, 3})));
  EXPECT_TRUE(exact_permutation(ControlPoints(162), Eigen::Matrix3d::Identity()));
}

TEST(Rotation, OfTheOctahedralGroupIsExactOnASubdividedOctahedron) {
  const ControlPoints points(Polyhedron::octahedron, 2);
  EXPECT_TRUE(exact_permutation(points, turn(std::numbers::pi / 2, {0, 0, 1})));
  EXPECT_FALSE(exact_permutation(points, turn(2 * std::numbers::pi / 5, {0, 0, 1})));
}

std::vector<double> displacements(const ControlPoints& points, const Eigen::Matrix3d& rotation,
                                  const PointPermutation& source) {
  std::vector<double> angle;
  for (int m = 0; m < points.size(); ++m) {
    const Direction moved = rotation * points.directions()[source[m]];
    angle.push_back(std::acos(std::min(1.0, moved.dot(points.directions()[m]))));
  }
  return angle;
}

TEST(Rotation, MatchesEveryPointWithOneOther) {
  const ControlPoints points(162, frame);
  for (const double angle : {0.05, 0.4, 0.7, 2.0}) {
    const Eigen::Matrix3d rotation = turn(angle, {1, 1, 3});
    double least_squares = 0;
    for (const Matching matching : {Matching::least_squares, Matching::best_first, Matching::outward}) {
      auto source = nearest_permutation(points, rotation, matching);
      const auto displacement = displacements(points, rotation, source);
      double sum = 0;  // of the squared chords
      for (const double a : displacement) sum += 2 - 2 * std::cos(a);
      if (matching == Matching::least_squares) {
        least_squares = sum;
        // No point need go further than the next one but one: sides are .28 to .32 rad.
        EXPECT_LT(*std::max_element(displacement.begin(), displacement.end()), 0.5);
      } else {
        // The last pairs left may lie anywhere, but they are few.
        EXPECT_LT(std::count_if(displacement.begin(), displacement.end(), [](double a) { return a > 0.32; }), 17);
        EXPECT_GE(sum, least_squares - 1e-12);
      }
      std::sort(source.begin(), source.end());
      std::vector<int> every(points.size());
      std::iota(every.begin(), every.end(), 0);
      EXPECT_EQ(source, every);
    }
  }
}

TEST(Rotation, BestFirstTakesTheClosestPairOfAll) {
  const ControlPoints points(42, frame);
  const Eigen::Matrix3d rotation = turn(0.3, {2, -1, 1});
  double closest = -1;
  int best_source = -1, best_target = -1;
  for (int s = 0; s < points.size(); ++s) {
    for (int t = 0; t < points.size(); ++t) {
      const double dot = (rotation * points.directions()[s]).dot(points.directions()[t]);
      if (dot > closest + 1e-12) {
        closest = dot;
        best_source = s;
        best_target = t;
      }
    }
  }
  EXPECT_EQ(nearest_permutation(points, rotation, Matching::best_first)[best_target], best_source);
}

TEST(Rotation, ByReweightingInterpolatesTheOldValues) {
  const auto points = std::make_shared<ControlPoints>(162, frame);
  const Eigen::Matrix3d rotation = turn(0.4, {1, -2, 0});
  const SphericalFunction f(points, peak);
  std::vector<double> rotated(points->size());
  reweight<double>(reweighting(*points, rotation), f.values(), rotated);
  for (int m = 0; m < points->size(); ++m) {
    EXPECT_NEAR(rotated[m], f(rotation.transpose() * points->directions()[m]), 1e-13);
  }
  // The sense of the rotation: the peak moves to its image under R.
  const auto top = std::max_element(rotated.begin(), rotated.end()) - rotated.begin();
  EXPECT_GT(points->directions()[top].dot(rotation * Direction(0.6, 0, 0.8)), std::cos(0.32));  // one side
}

TEST(Rotation, TurnsManyFunctionsLikeOne) {
  const ControlPoints points(42);
  const Eigen::Matrix3d rotation = turn(0.5, {1, 2, 3});
  const std::size_t functions = 3;
  std::vector<float> values(42 * functions), moved(values.size()), weighted(values.size());
  std::iota(values.begin(), values.end(), 1.0f);
  const auto source = nearest_permutation(points, rotation, Matching::outward);
  const auto stencils = reweighting(points, rotation);
  permute<float>(source, values, moved);
  reweight<float>(stencils, values, weighted);
  for (std::size_t m = 0; m < 42; ++m) {
    for (std::size_t n = 0; n < functions; ++n) {
      EXPECT_EQ(moved[m * functions + n], values[source[m] * functions + n]);
      double expected = 0;
      for (int k = 0; k < 3; ++k) expected += stencils[m].weight[k] * values[stencils[m].index[k] * functions + n];
      EXPECT_NEAR(weighted[m * functions + n], expected, 126 * 4e-7);  // three roundings of float
    }
  }
}

}  // namespace
}  // namespace cloudbow
