// Positions of the voxels of a grid. Truth: a row of the matrix times an index is the world position of the index.
#include <gmock/gmock.h>
#include <openvdb/openvdb.h>

#include <cmath>

#include "vdb_test_tools.hpp"

namespace cloudbow {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

// Truth: a row of the matrix times an index is the world position of the index; two voxels distinguish the axes.
TEST_F(VdbFile, AxesExchangedAndMirroredByTheMatrixAreReadExactly) {
  // i runs along x, j along z, k against y, as programs with y up write it; voxel centres at multiples of 10 m.
  const auto transposed = openvdb::math::Transform::createLinearTransform(
      openvdb::Mat4d(10.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0, 0.0, 0.0, -30.0, 0.0, 0.0, 5.0, 6.0, 7.0, 1.0));
  const auto path = write_seekable({with_transform(
      density_grid({{Coord(0, 0, 0), 1.0F}, {Coord(2, 0, 0), 2.0F}, {Coord(0, 1, 0), 3.0F}, {Coord(0, 0, 1), 4.0F}}),
      transposed)});
  const CloudField field = read_cloud_vdb(path);
  EXPECT_THAT(field.cell_size_m, ElementsAre(10, 30, 20));
  EXPECT_THAT(field.min_m, ElementsAre(0, -39, -3));  // x: 5 - 5; y: 6 - 30 - 15; z: 7 - 10
  EXPECT_THAT(field.cells, ElementsAre(3, 2, 2));
  EXPECT_THAT(to_dense(field), ElementsAre(4, 0, 0, 1, 0, 2,  //
                                           0, 0, 0, 3, 0, 0));

  // Up is y on top of it: (x, y, z) becomes (x, -z, y).
  const CloudField y_up = read_cloud_vdb(path, {.up_axis = "y"});
  EXPECT_THAT(y_up.cell_size_m, ElementsAre(10, 20, 30));
  EXPECT_THAT(y_up.min_m, ElementsAre(0, -37, -39));
  EXPECT_THAT(to_dense(y_up), ElementsAre(0, 0, 0, 4, 0, 0,  //
                                          3, 0, 0, 1, 0, 2));

  const auto mirrored = openvdb::math::Transform::createLinearTransform(
      openvdb::Mat4d(-10.0, 0.0, 0.0, 0.0, 0.0, 10.0, 0.0, 0.0, 0.0, 0.0, -10.0, 0.0, 0.0, 0.0, 0.0, 1.0));
  const CloudField backwards = read_cloud_vdb(write_seekable({with_transform(
      density_grid({{Coord(0, 0, 0), 1.0F}, {Coord(1, 0, 0), 2.0F}, {Coord(0, 0, 1), 3.0F}}), mirrored)}));
  EXPECT_THAT(backwards.min_m, ElementsAre(-15, -5, -15));
  EXPECT_THAT(to_dense(backwards), ElementsAre(0, 3, 2, 1));
}

TEST_F(VdbFile, CompanionsFollowATransformOfTheirOwn) {
  const auto cloud_grid = density_grid({{Coord(0, 0, 0), 1.0F}, {Coord(1, 0, 0), 2.0F}});
  auto albedo = density_grid({{Coord(0, 0, 0), 0.1F}, {Coord(-1, 0, 0), 0.2F}}, "albedo");
  with_transform(albedo, openvdb::math::Transform::createLinearTransform(openvdb::Mat4d(
                             -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)));
  const auto path = write_seekable({cloud_grid, albedo});
  EXPECT_THAT(read_auxiliary_vdb(path, read_cloud_vdb(path), {.grid = "albedo"}, 0, 1), ElementsAre(0.1F, 0.2F));
}

TEST_F(VdbFile, TransformsThatTurnOrShearAreErrors) {
  using openvdb::Mat4d;
  const auto transposed = Mat4d(8.0, 6.0, 0.0, 0.0, -6.0, 8.0, 0.0, 0.0, 0.0, 0.0, 10.0, 0.0, 0.0, 0.0, 0.0, 1.0);
  const auto slightly_turned =
      Mat4d(10.0, 1e-4, 0.0, 0.0, -1e-4, 10.0, 0.0, 0.0, 0.0, 0.0, 10.0, 0.0, 0.0, 0.0, 0.0, 1.0);
  const auto sheared = Mat4d(10.0, 0.0, 0.0, 0.0, 0.0, 10.0, 0.0, 0.0, 3.0, 0.0, 10.0, 0.0, 0.0, 0.0, 0.0, 1.0);
  // Two indices along one axis.
  const auto steep = Mat4d(10.0, 0.0, 0.0, 0.0, 11.0, 10.0, 0.0, 0.0, 0.0, 0.0, 10.0, 0.0, 0.0, 0.0, 0.0, 1.0);
  for (const auto& matrix : {transposed, slightly_turned, sheared, steep}) {
    EXPECT_THAT(read_message({with_matrix(matrix)}), AllOf(HasSubstr("rotates or shears"), HasSubstr("resample")));
  }
  const auto frustum = openvdb::math::Transform::createFrustumTransform(openvdb::BBoxd(Vec3d(0), Vec3d(10)),
                                                                        /*taper=*/0.5, /*depth=*/10.0);
  EXPECT_THAT(read_message({with_transform(density_grid({{Coord(0, 0, 0), 1.0F}}), frustum)}),
              AllOf(HasSubstr("NonlinearFrustumMap"), HasSubstr("resample")));
}

TEST_F(VdbFile, TheTransformGivesTheCentresOfVoxels) {
  const auto transform = openvdb::math::Transform::createLinearTransform(
      openvdb::Mat4d(10.0, 0.0, 0.0, 0.0, 0.0, 20.0, 0.0, 0.0, 0.0, 0.0, 5.0, 0.0, 100.0, 200.0, 300.0, 1.0));
  const auto path =
      write_seekable({with_transform(density_grid({{Coord(-2, 1, 3), 0.5F}, {Coord(0, 1, 4), 0.25F}}), transform)});
  const CloudField field = read_cloud_vdb(path);
  EXPECT_THAT(field.cells, ElementsAre(3, 1, 2));
  EXPECT_THAT(field.cell_size_m, ElementsAre(10, 20, 5));
  EXPECT_THAT(field.min_m, ElementsAre(75, 210, 312.5));
  EXPECT_THAT(to_dense(field), ElementsAre(0.5F, 0, 0, 0, 0, 0.25F));
  EXPECT_EQ(field.quantity, "");
}

TEST_F(VdbFile, OtherAxesUpAreTurnedNotMirrored) {
  // Three voxels of unit size along the file's axes, with different values, and a translation.
  const auto transform = openvdb::math::Transform::createLinearTransform(
      openvdb::Mat4d(1.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 10.0, 20.0, 30.0, 1.0));
  const auto path = write_seekable({with_transform(
      density_grid({{Coord(0, 0, 0), 1.0F}, {Coord(1, 0, 0), 2.0F}, {Coord(0, 1, 0), 3.0F}, {Coord(0, 0, 1), 4.0F}}),
      transform)});

  const CloudField y_up = read_cloud_vdb(path, {.up_axis = "y"});  // (x, y, z) -> (x, -z, y)
  EXPECT_THAT(y_up.cell_size_m, ElementsAre(1, 3, 2));
  EXPECT_THAT(y_up.min_m, ElementsAre(9.5, -34.5, 19));
  EXPECT_THAT(to_dense(y_up), ElementsAre(4, 0, 1, 2,  //
                                          0, 0, 3, 0));

  const CloudField x_up = read_cloud_vdb(path, {.up_axis = "x"});  // (x, y, z) -> (y, z, x)
  EXPECT_THAT(x_up.cell_size_m, ElementsAre(2, 3, 1));
  EXPECT_THAT(x_up.min_m, ElementsAre(19, 28.5, 9.5));
  EXPECT_THAT(to_dense(x_up), ElementsAre(1, 3, 4, 0,  //
                                          2, 0, 0, 0));
}

TEST_F(VdbFile, AnotherVoxelSizeStretchesAboutTheOrigin) {
  write_cloud_vdb(file(), small_field());
  const CloudField field = read_cloud_vdb(file(), {.voxel_size_m = std::array<double, 3>{40, 30, 25}});
  EXPECT_THAT(field.cells, ElementsAre(5, 3, 2));
  EXPECT_THAT(field.cell_size_m, ElementsAre(40, 30, 25));
  EXPECT_THAT(field.min_m, ElementsAre(-14, 11, 800));
}

TEST_F(VdbFile, MetadataGiveTheDomain) {
  const auto grid = density_grid({{Coord(2, 2, 2), 1.0F}});  // faces at whole numbers and a half
  grid->insertMeta("domain_min_m", openvdb::Vec3SMetadata({-0.5F, -0.5F, 1.5F}));
  grid->insertMeta("domain_max_m", openvdb::Vec3DMetadata({4.5, 2.5, 7.5004}));
  const CloudField field = read_cloud_vdb(write_seekable({grid}));
  EXPECT_THAT(field.cells, ElementsAre(5, 3, 6));
  EXPECT_THAT(field.min_m, ElementsAre(-0.5, -0.5, 1.5));

  const auto transposed = read_cloud_vdb(file(), {.up_axis = "y"});
  EXPECT_THAT(transposed.cells, ElementsAre(5, 6, 3));
  EXPECT_NEAR(transposed.min_m[1], -7.5, 1e-3);
}

TEST_F(VdbFile, MetadataThatCannotBeTheDomainAreErrors) {
  const auto message = [&](const openvdb::Metadata& low, const openvdb::Metadata& high) {
    const auto grid = density_grid({{Coord(2, 2, 2), 1.0F}});
    grid->insertMeta("domain_min_m", low);
    grid->insertMeta("domain_max_m", high);
    return read_message({grid});
  };
  const openvdb::Vec3DMetadata low({-0.5, -0.5, -0.5});
  const openvdb::Vec3DMetadata high({4.5, 4.5, 4.5});
  EXPECT_THAT(message(low, openvdb::Vec3DMetadata({4.5, 4.502, 4.5})),
              HasSubstr("does not end on voxel faces (y = 4.502 m found, 4.5 m is the nearest face)"));
  EXPECT_THAT(message(low, openvdb::Vec3DMetadata({4.5, 4.5, 1.5})),
              HasSubstr("does not contain the cloud (along z the cloud reaches from 1.5 to 2.5 m"));
  EXPECT_THAT(message(low, openvdb::Vec3DMetadata({-4.5, 4.5, 4.5})),
              HasSubstr("is empty (found -0.5 to -4.5 m along x"));
  EXPECT_THAT(message(low, openvdb::Vec3DMetadata({std::nan(""), 4.5, 4.5})), HasSubstr("domain_max_m is not finite"));
  EXPECT_THAT(message(openvdb::Vec3IMetadata({0, 0, 0}), high),
              HasSubstr("does not end on voxel faces (x = 0 m found"));
  EXPECT_THAT(message(openvdb::StringMetadata("0 0 0"), high),
              HasSubstr("domain_min_m has the wrong type (string found"));
  EXPECT_THAT(message(low, openvdb::Vec3DMetadata({4e12 + 0.5, 4.5, 4.5})), HasSubstr("too large"));

  const auto lone = density_grid({{Coord(2, 2, 2), 1.0F}});
  lone->insertMeta("domain_min_m", low);
  EXPECT_THAT(read_message({lone}), HasSubstr("domain_max_m is missing"));
}

}  // namespace
}  // namespace cloudbow
