// Faces of voxels that corners of a domain lie on. Truth: multiples of the voxel size.
#include <gtest/gtest.h>

#include "app/assembly/open_cloud.hpp"

namespace cloudbow {
namespace {

CloudField field() {
  return make_cloud_field({2, 1, 1}, {25, 50, 10}, {-30, 100, 500}, std::vector<float>{1, 1}, "extinction");
}

TEST(VoxelFaces, LieAtMultiplesOfTheVoxelSize) {
  const CloudField cloud = field();
  for (const double face : {-30., -5., 20., 45., -1030., 970.}) {
    EXPECT_TRUE(lies_on_face(cloud, 0, face)) << face;
    EXPECT_EQ(onto_face(cloud, 0, face), face);
  }
  EXPECT_TRUE(lies_on_face(cloud, 1, 150));
  EXPECT_TRUE(lies_on_face(cloud, 2, 490));
}

TEST(VoxelFaces, TakeCoordinatesWithinTheTolerance) {
  const CloudField cloud = field();
  const double near = -5 + .5 * face_tolerance * 25, far = -5 + 2 * face_tolerance * 25;
  EXPECT_TRUE(lies_on_face(cloud, 0, near));
  EXPECT_DOUBLE_EQ(onto_face(cloud, 0, near), -5);
  EXPECT_FALSE(lies_on_face(cloud, 0, far));
  EXPECT_EQ(onto_face(cloud, 0, far), far);
}

}  // namespace
}  // namespace cloudbow
