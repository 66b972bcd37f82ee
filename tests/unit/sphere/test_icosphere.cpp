// The icosphere and its symmetry. Truth: Euler's formula, and the order of the group.
#include <gtest/gtest.h>

#include "cloudbow/sphere/icosphere.hpp"

namespace cloudbow {
namespace {

TEST(Icosphere, HasItsVertices) {
  for (int n = 0; n < 4; ++n) EXPECT_EQ(make_icosphere(n).vertex.size(), 10U * (1U << (2 * n)) + 2U);
}

TEST(IcosahedralGroup, MapsTheVerticesOntoThemselves) {
  const std::vector<Eigen::Matrix3d> group = icosahedral_group();
  ASSERT_EQ(group.size(), 120U);
  EXPECT_LT((group.front() - Eigen::Matrix3d::Identity()).norm(), 1e-15);
  const Icosphere sphere = make_icosphere(1);
  int rotations = 0;
  for (const Eigen::Matrix3d& element : group) {
    EXPECT_LT((element * element.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    if (element.determinant() > 0) ++rotations;
    for (const Direction& vertex : sphere.vertex) {
      double nearest = 10;
      for (const Direction& other : sphere.vertex) nearest = std::min(nearest, (element * vertex - other).norm());
      EXPECT_LT(nearest, 1e-14);  // rounding
    }
  }
  EXPECT_EQ(rotations, 60);
}

TEST(IcosahedralGroup, HasNoElementTwice) {
  const std::vector<Eigen::Matrix3d> group = icosahedral_group();
  for (std::size_t a = 0; a < group.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) EXPECT_GT((group[a] - group[b]).norm(), .1);
  }
}

}  // namespace
}  // namespace cloudbow
