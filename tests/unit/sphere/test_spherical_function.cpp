#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cloudbow/core/error.hpp"
#include "cloudbow/sphere/spherical_function.hpp"
#include "directions.hpp"

namespace cloudbow {
namespace {

double smooth(const Direction& v) { return 2 + v.x() - 0.5 * v.y() * v.z(); }

class OnControlPoints : public testing::Test {
 protected:
  std::shared_ptr<const ControlPoints> points_ = std::make_shared<ControlPoints>(162);
  SphericalFunction function_{points_, smooth};
};

TEST_F(OnControlPoints, HasItsValuesAtThePointsAndWeightedOnesBetween) {
  for (int m = 0; m < points_->size(); ++m) {
    EXPECT_NEAR(function_(points_->directions()[m]), smooth(points_->directions()[m]), 1e-13);
  }
  const Direction d = Direction(0.2, -0.7, 0.4).normalized();
  const auto [index, weight] = points_->stencil(d);
  double expected = 0;
  for (int k = 0; k < 3; ++k) expected += weight[k] * function_.values()[index[k]];
  EXPECT_DOUBLE_EQ(function_(d), expected);
}

TEST_F(OnControlPoints, IsScaledAndAddedValueByValue) {
  SphericalFunction sum(points_, [](const Direction& v) { return v.z(); });
  sum *= 3;
  sum += function_;
  for (const Direction& d : random_directions(50)) {
    double z = 0;
    const auto [index, weight] = points_->stencil(d);
    for (int k = 0; k < 3; ++k) z += weight[k] * points_->directions()[index[k]].z();
    EXPECT_NEAR(sum(d), function_(d) + 3 * z, 1e-14);  // interpolation is linear
  }
}

template <class Real>
class Batch : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(Batch, Reals);

TYPED_TEST(Batch, QueriesEveryFunctionLikeItselfAlone) {
  using Real = TypeParam;
  const ControlPoints points(42);
  const int functions = 2500;  // two blocks and a part
  std::vector<Real> values;
  for (const Direction& v : points.directions()) {
    for (int n = 0; n < functions; ++n) values.push_back(static_cast<Real>(std::cos(n * v.x()) + v.y()));
  }
  std::vector<Stencil> stencils;
  for (const Direction& d : random_directions(5)) stencils.push_back(points.stencil(d));
  std::vector<Real> all(stencils.size() * functions), one(functions);
  query<Real>(stencils, functions, values, all);
  for (std::size_t d = 0; d < stencils.size(); ++d) {
    query<Real>(stencils[d], values, one);
    for (int n = 0; n < functions; ++n) {
      double expected = 0;
      for (int k = 0; k < 3; ++k) expected += stencils[d].weight[k] * values[stencils[d].index[k] * functions + n];
      EXPECT_NEAR(all[d * functions + n], expected, 4.0 * std::numeric_limits<Real>::epsilon());
      EXPECT_EQ(all[d * functions + n], one[n]);
    }
  }
}

TYPED_TEST(Batch, ScalesAndAdds) {
  std::vector<TypeParam> sum = {1, 2, 3};
  add_scaled<TypeParam>(2, std::vector<TypeParam>{10, 20, -30}, sum);
  EXPECT_EQ(sum, (std::vector<TypeParam>{21, 42, -57}));
}

TEST_F(OnControlPoints, DeformedTakesTheValueGivenAndKeepsWhatIsOutOfReach) {
  const double reach = 0.6;
  for (const Direction& centre : random_directions(50)) {
    SphericalFunction deformed = function_;
    deformed.deform(centre, 7.5, reach);
    EXPECT_NEAR(deformed(centre), 7.5, 1e-13);
    for (int m = 0; m < points_->size(); ++m) {
      const double angle = std::acos(std::clamp(points_->directions()[m].dot(centre), -1.0, 1.0));
      if (angle > reach) {
        EXPECT_EQ(deformed.values()[m], function_.values()[m]);
      }
      EXPECT_GE(deformed.values()[m], function_.values()[m]);  // it was raised: nothing sinks
    }
  }
}

// Truth: the definition, that the value there moves by the change and nothing else does. Also the closed form of the
// least-norm solution of one equation w . d = change, whose norm is |change| / |w|.
TEST_F(OnControlPoints, MovesTheValueAtADirectionByTheSmallestChange) {
  const double change = 2.5;
  for (const Direction& direction : random_directions(200)) {
    SphericalFunction moved = function_;
    moved.move_value_at(direction, change);
    EXPECT_NEAR(moved(direction), function_(direction) + change, 1e-14);  // a few roundings of numbers up to 6
    const auto [index, weight] = points_->stencil(direction);
    double squares = 0, weights = 0;
    for (int m = 0; m < points_->size(); ++m) {
      const double difference = moved.values()[m] - function_.values()[m];
      squares += difference * difference;
      if (std::find(index.begin(), index.end(), m) == index.end()) {
        EXPECT_EQ(difference, 0);
      }
    }
    for (const double w : weight) weights += w * w;
    EXPECT_NEAR(std::sqrt(squares), change / std::sqrt(weights), 1e-13);
    // Any other change of the three that does the same is larger: here one moved along the plane w . d = 0.
    std::array<double, 3> other{};
    double larger = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      other[k] =
          moved.values()[index[k]] - function_.values()[index[k]] + 0.1 * (weight[(k + 1) % 3] - weight[(k + 2) % 3]);
      larger += other[k] * other[k];
    }
    EXPECT_NEAR(weight[0] * other[0] + weight[1] * other[1] + weight[2] * other[2], change, 1e-13);
    EXPECT_GE(larger, squares - 1e-12);  // equal if all weights are
  }
}

TEST_F(OnControlPoints, MovesAControlPointAlone) {
  SphericalFunction moved = function_;
  moved.move_value_at(points_->directions()[20], -1);
  for (int m = 0; m < points_->size(); ++m)
    EXPECT_NEAR(moved.values()[m], function_.values()[m] - (m == 20 ? 1 : 0), 1e-13);
}

TEST_F(OnControlPoints, LobeFallsOffFromItsCentre) {
  const Direction centre = points_->directions()[20];
  const auto lobe = deformation_lobe(*points_, centre, 1.0);
  EXPECT_NEAR(lobe[20], 1, 1e-14);
  for (int m = 0; m < points_->size(); ++m) {
    const double x = std::acos(std::clamp(points_->directions()[m].dot(centre), -1.0, 1.0));
    EXPECT_NEAR(lobe[m], x < 1 ? std::pow(1 - x * x, 2) : 0, 1e-12);
  }
}

TEST_F(OnControlPoints, DeformationMustReachTheCornersButNotRoundTheSphere) {
  EXPECT_THROW(function_.deform({0, 0, 1}, 1, 0.1), InputError);  // sides are .28 rad and longer
  EXPECT_THROW(function_.deform({0, 0, 1}, 1, 3.2), InputError);
  EXPECT_THROW(function_.deform({0, 0, 1}, 1, std::nan("")), InputError);
  EXPECT_NO_THROW(function_.deform({0, 0, 1}, 1, std::numbers::pi));
}

}  // namespace
}  // namespace cloudbow
