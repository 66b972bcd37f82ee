// Grids as other programs write them: axes, backgrounds, rounding, names. Each is read correctly or refused with a
// remedy.
#include <cmath>
#include <limits>

#include "vdb_test_tools.hpp"

namespace cloudbow {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using openvdb::Vec3d;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

namespace fs = std::filesystem;

using VdbGrids = VdbFile;

// Truth: a row of the matrix times an index is the world position of the index; two voxels distinguish the axes.
TEST_F(VdbGrids, AxesExchangedAndMirroredByTheMatrixAreReadExactly) {
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

TEST_F(VdbGrids, CompanionsFollowATransformOfTheirOwn) {
  const auto cloud_grid = density_grid({{Coord(0, 0, 0), 1.0F}, {Coord(1, 0, 0), 2.0F}});
  auto albedo = density_grid({{Coord(0, 0, 0), 0.1F}, {Coord(-1, 0, 0), 0.2F}}, "albedo");
  with_transform(albedo, openvdb::math::Transform::createLinearTransform(openvdb::Mat4d(
                             -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)));
  const auto path = write_seekable({cloud_grid, albedo});
  EXPECT_THAT(read_auxiliary_vdb(path, read_cloud_vdb(path), {.grid = "albedo"}, 0, 1), ElementsAre(0.1F, 0.2F));
}

TEST_F(VdbGrids, TransformsThatTurnOrShearAreErrors) {
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

FloatGrid::Ptr with_background(float background, const std::vector<std::pair<Coord, float>>& voxels) {
  auto grid = FloatGrid::create(background);
  grid->setName("density");
  for (const auto& [index, value] : voxels) grid->tree().setValueOn(index, value);
  return grid;
}

void set_domain(FloatGrid& grid, const Vec3d& low, const Vec3d& high) {
  grid.insertMeta("domain_min_m", openvdb::Vec3DMetadata(low));
  grid.insertMeta("domain_max_m", openvdb::Vec3DMetadata(high));
}

// Truth: OpenVDB's documentation: the background is the value of every voxel that the tree does not hold.
TEST_F(VdbGrids, TheBackgroundFillsTheDomainOfTheMetadata) {
  const auto grid = with_background(0.25F, {{Coord(1, 0, 0), 1.0F}, {Coord(1, 0, 1), 0.0F}});
  set_domain(*grid, {-0.5, -0.5, -0.5}, {2.5, 0.5, 1.5});
  const CloudField field = read_cloud_vdb(write_seekable({grid}), {.scale = 2});
  EXPECT_THAT(to_dense(field), ElementsAre(0.5F, 2, 0.5F, 0.5F, 0, 0.5F));
  // The scene's domain does not widen the extent in the grid's metadata.
  EXPECT_EQ(read_cloud_vdb(file(), {.domain_m = VdbDomain{{-9.5, -9.5, -9.5}, {9.5, 9.5, 9.5}}}).active_voxels(), 5U);
  // (x, y, z) becomes (x, -z, y): the rows along x change places.
  EXPECT_THAT(to_dense(read_cloud_vdb(file(), {.up_axis = "y"})), ElementsAre(0.25F, 0, 0.25F, 0.25F, 1, 0.25F));
}

TEST_F(VdbGrids, TheBackgroundFillsTheDomainOfTheScene) {
  const auto path = write_seekable({with_background(0.25F, {{Coord(1, 0, 0), 1.0F}})});
  const CloudField field = read_cloud_vdb(path, {.domain_m = VdbDomain{{0.5, -0.5, -0.5}, {3.5, 0.5, 0.5}}});
  EXPECT_THAT(to_dense(field), ElementsAre(1, 0.25F, 0.25F));
  EXPECT_THAT(message_of([&] {
                read_cloud_vdb(path, {.domain_m = VdbDomain{{0.2, -0.5, -0.5}, {3.5, 0.5, 0.5}}});
              }),
              HasSubstr("the domain of the scene does not end on voxel faces"));
  EXPECT_THAT(message_of([&] {
                read_cloud_vdb(path, {.domain_m = VdbDomain{{3.5, -0.5, -0.5}, {0.5, 0.5, 0.5}}});
              }),
              HasSubstr("the domain of the scene is empty"));
  EXPECT_THAT(message_of([&] {
                read_cloud_vdb(path,
                               {.domain_m = VdbDomain{{-1e5 - 0.5, -1e5 - 0.5, -0.5}, {1e5 + 0.5, 1e5 + 0.5, 99.5}},
                                .memory_limit_bytes = 1000000});
              }),
              HasSubstr("too large (4000040000100 active voxels"));
}

TEST_F(VdbGrids, ABackgroundWithoutEndIsRefusedWithTheWayOut) {
  const auto grid = with_background(0.25F, {{Coord(1, 2, 3), 1.0F}, {Coord(2, 2, 3), 1.0F}});
  EXPECT_THAT(read_message({grid}), AllOf(HasSubstr("the background is 0.25"), HasSubstr("[domain]"),
                                          HasSubstr("min_m = [0.5, 1.5, 2.5], max_m = [2.5, 2.5, 3.5]")));
  EXPECT_EQ(read_cloud_vdb(file(), {.ignores_background = true}).active_voxels(), 2U);
  EXPECT_THAT(read_message({with_background(0.25F, {})}), HasSubstr("the background is 0.25"));
  for (const float background : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
    EXPECT_THAT(read_message({with_background(background, {{Coord(1, 2, 3), 1.0F}})}),
                HasSubstr("a finite number is allowed"));
  }
  const auto negative = with_background(-1.0F, {{Coord(1, 2, 3), 1.0F}});
  set_domain(*negative, {0.5, 1.5, 1.5}, {1.5, 2.5, 3.5});
  EXPECT_THAT(read_message({negative}), HasSubstr("voxel (1, 2, 2) has the value -1"));
}

TEST_F(VdbGrids, InactiveValuesBesideTheBackgroundAreNoted) {
  const auto grid = density_grid({{Coord(0, 0, 0), 1.0F}});
  grid->tree().setValueOff(Coord(1, 0, 0), 0.5F);
  const VdbCloud field = read_cloud_vdb(write_seekable({grid}));
  EXPECT_EQ(field.active_voxels(), 1U);
  EXPECT_THAT(field.notes, ElementsAre(AllOf(HasSubstr("1 voxels that are not active"), HasSubstr("0.5"))));
}

// 1e-5 of the largest: the rounding of the difference of two numbers of 32 bits.
TEST_F(VdbGrids, NegativeRoundingCountsAsZeroAndIsSaid) {
  const VdbCloud field = read_cloud_vdb(
      write_seekable({density_grid({{Coord(0, 0, 0), 1.0F}, {Coord(1, 0, 0), -9e-6F}, {Coord(2, 0, 0), -1e-9F}})}));
  EXPECT_EQ(field.active_voxels(), 1U);
  EXPECT_THAT(field.notes, ElementsAre(AllOf(HasSubstr("2 negative values down to -9e-06 count as 0"))));
  EXPECT_THAT(read_message({density_grid({{Coord(0, 0, 0), 1.0F}, {Coord(1, 0, 0), -1.1e-5F}})}),
              AllOf(HasSubstr("voxel (1, 0, 0) has the value -1.1"), HasSubstr("counts as 0")));
}

TEST_F(VdbGrids, StrayVoxelsAreNoted) {
  std::vector<std::pair<Coord, float>> voxels{{Coord(4000, 3000, 100), 1e-6F}};
  for (int n = 0; n < 1000; ++n) voxels.push_back({Coord(n % 10, n / 10 % 10, n / 100), 0.01F});
  const VdbCloud field = read_cloud_vdb(write_seekable({density_grid(voxels)}));
  EXPECT_THAT(field.cells, ElementsAre(4001, 3001, 101));
  EXPECT_THAT(field.notes,
              ElementsAre(AllOf(HasSubstr("10 x 10 x 10 cells"), HasSubstr("(4000, 3000, 100)"), HasSubstr("clip"))));
  // Two clouds far from each other are both intended.
  voxels.front() = {Coord(0, 0, 0), 0.01F};
  for (int n = 0; n < 1000; ++n) voxels.push_back({Coord(4000 + n % 10, 3000 + n / 10 % 10, n / 100), 0.01F});
  EXPECT_THAT(read_cloud_vdb(write_seekable({density_grid(voxels)})).notes, testing::IsEmpty());
}

TEST_F(VdbGrids, GridsOfOneNameAreToldApartByNumber) {
  const openvdb::GridPtrVec twins{density_grid({{Coord(0, 0, 0), 1.0F}}), density_grid({{Coord(0, 0, 0), 2.0F}})};
  EXPECT_THAT(read_message(twins), HasSubstr("several have this name: choose one of \"density[0]\", \"density[1]\""));
  EXPECT_THAT(read_cloud_vdb(file(), {.grid = "density[1]"}).value, ElementsAre(2.0F));
}

TEST_F(VdbGrids, FilesOfOtherKindsPointToTheImport) {
  std::ofstream(file("les.nc"), std::ios::binary) << "\x89HDF\r\n\x1a\n and more";
  EXPECT_THAT(
      message_of([&] { read_cloud_vdb(file("les.nc")); }),
      AllOf(HasSubstr("HDF5 or netCDF-4"), HasSubstr("cloudbow cloud import"), HasSubstr("les.nc -o cloud.vdb")));
  std::ofstream(file("old.nc"), std::ios::binary) << "CDF\x01 and more";
  EXPECT_THAT(message_of([&] { read_cloud_vdb(file("old.nc")); }),
              AllOf(HasSubstr("those of netCDF)"), HasSubstr("cloudbow cloud import")));
}

TEST_F(VdbGrids, VoxelsThatOpenVdbTakesForSingularAreNotWritten) {
  EXPECT_THAT(message_of([&] {
                write_cloud_vdb(file(), make_cloud_field({1, 1, 1}, {1e-300, 50, 50}, {0, 0, 0}, {1.0F}, "extinction"));
              }),
              AllOf(HasSubstr("voxel size: too small"), HasSubstr("1e-300")));
  EXPECT_FALSE(fs::exists(file()));
}

}  // namespace
}  // namespace cloudbow
