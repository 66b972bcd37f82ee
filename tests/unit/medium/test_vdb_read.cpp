// Voxels of a grid become cells. Truth: the values of the grid at the positions of its voxels.
#include <gmock/gmock.h>
#include <openvdb/openvdb.h>

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
TEST_F(VdbFile, TheBackgroundFillsTheDomainOfTheMetadata) {
  const auto grid = with_background(0.25F, {{Coord(1, 0, 0), 1.0F}, {Coord(1, 0, 1), 0.0F}});
  set_domain(*grid, {-0.5, -0.5, -0.5}, {2.5, 0.5, 1.5});
  const CloudField field = read_cloud_vdb(write_seekable({grid}), {.scale = 2});
  EXPECT_THAT(to_dense(field), ElementsAre(0.5F, 2, 0.5F, 0.5F, 0, 0.5F));
  // The scene's domain does not widen the extent in the grid's metadata.
  EXPECT_EQ(read_cloud_vdb(file(), {.domain_m = VdbDomain{{-9.5, -9.5, -9.5}, {9.5, 9.5, 9.5}}}).active_voxels(), 5U);
  // (x, y, z) becomes (x, -z, y): the rows along x change places.
  EXPECT_THAT(to_dense(read_cloud_vdb(file(), {.up_axis = "y"})), ElementsAre(0.25F, 0, 0.25F, 0.25F, 1, 0.25F));
}

TEST_F(VdbFile, TheBackgroundFillsTheDomainOfTheScene) {
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

TEST_F(VdbFile, ABackgroundWithoutEndIsRefusedWithTheWayOut) {
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

TEST_F(VdbFile, InactiveValuesBesideTheBackgroundAreNoted) {
  const auto grid = density_grid({{Coord(0, 0, 0), 1.0F}});
  grid->tree().setValueOff(Coord(1, 0, 0), 0.5F);
  const VdbCloud field = read_cloud_vdb(write_seekable({grid}));
  EXPECT_EQ(field.active_voxels(), 1U);
  EXPECT_THAT(field.notes, ElementsAre(AllOf(HasSubstr("1 voxels that are not active"), HasSubstr("0.5"))));
}

// 1e-5 of the largest: the rounding of the difference of two numbers of 32 bits.
TEST_F(VdbFile, NegativeRoundingCountsAsZeroAndIsSaid) {
  const VdbCloud field = read_cloud_vdb(
      write_seekable({density_grid({{Coord(0, 0, 0), 1.0F}, {Coord(1, 0, 0), -9e-6F}, {Coord(2, 0, 0), -1e-9F}})}));
  EXPECT_EQ(field.active_voxels(), 1U);
  EXPECT_THAT(field.notes, ElementsAre(AllOf(HasSubstr("2 negative values down to -9e-06 count as 0"))));
  EXPECT_THAT(read_message({density_grid({{Coord(0, 0, 0), 1.0F}, {Coord(1, 0, 0), -1.1e-5F}})}),
              AllOf(HasSubstr("voxel (1, 0, 0) has the value -1.1"), HasSubstr("counts as 0")));
}

TEST_F(VdbFile, StrayVoxelsAreNoted) {
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

TEST_F(VdbFile, ActiveZerosAreClearAir) {
  const auto path =
      write_seekable({density_grid({{Coord(0, 0, 0), 0.0F}, {Coord(5, 5, 5), 1.0F}, {Coord(6, 5, 5), -0.0F}})});
  const CloudField field = read_cloud_vdb(path);
  EXPECT_THAT(field.cells, ElementsAre(1, 1, 1));
  EXPECT_EQ(field.active_voxels(), 1U);
}

TEST_F(VdbFile, RowsAreInOrderAcrossLeaves) {
  std::vector<std::pair<Coord, float>> voxels;
  for (int x = -20; x < 20; x += 3) {
    for (int y = -9; y < 9; ++y) {
      for (int z = -17; z < 3; z += 2)
        voxels.push_back({Coord(x, y, z), static_cast<float>(1 + (x + 20) + 40 * (y + 9) + 1000 * (z + 17))});
    }
  }
  const CloudField field = read_cloud_vdb(write_stream({density_grid(voxels)}));
  EXPECT_THAT(field.cells, ElementsAre(40, 18, 19));
  const auto dense = to_dense(field);
  for (const auto& [index, value] : voxels) {
    EXPECT_EQ(dense[static_cast<std::size_t>(((index[2] + 17) * 18 + index[1] + 9) * 40 + index[0] + 20)], value);
  }
  EXPECT_EQ(field.active_voxels(), voxels.size());
}

TEST_F(VdbFile, TheScaleMultiplies) {
  const auto path = write_seekable({density_grid({{Coord(0, 0, 0), 3.0F}})});
  EXPECT_FLOAT_EQ(read_cloud_vdb(path, {.scale = 0.001}).value.at(0), 0.003F);
  for (const double scale :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(message_of([&] { read_cloud_vdb(path, {.scale = scale}); }), HasSubstr("scale: out of range"));
  }
  EXPECT_THAT(message_of([&] { read_cloud_vdb(path, {.scale = 1e39}); }),
              HasSubstr("voxel (0, 0, 0) has the value 3 times the scale 1e+39"));
}

TEST_F(VdbFile, OptionsOutOfRangeAreErrors) {
  const auto path = write_seekable({density_grid({{Coord(0, 0, 0), 3.0F}})});
  EXPECT_THAT(message_of([&] { read_cloud_vdb(path, {.up_axis = "w"}); }),
              HasSubstr("up_axis: unknown axis (\"w\" found"));
  EXPECT_THAT(message_of([&] {
                read_cloud_vdb(path, {.voxel_size_m = std::array<double, 3>{1, 0, 1}});
              }),
              HasSubstr("voxel_size_m: out of range (0 found"));
}

TEST_F(VdbFile, ActiveTilesAreExpanded) {
  auto grid = density_grid({{Coord(16, 0, 0), 2.0F}});
  grid->tree().addTile(1, Coord(8, 0, 0), 1.0F, true);
  ASSERT_EQ(grid->tree().activeTileCount(), 1U);
  const CloudField field = read_cloud_vdb(write_seekable({grid}));
  EXPECT_THAT(field.cells, ElementsAre(9, 8, 8));
  EXPECT_EQ(field.active_voxels(), 513U);
  EXPECT_EQ(field.spans.front().n, 9);
}

TEST_F(VdbFile, HugeTilesAndBoxesAreRefusedBeforeTheyTakeMemory) {
  auto tile = density_grid({});
  tile->tree().addTile(3, Coord(0, 0, 0), 1.0F, true);
  auto box = density_grid({{Coord(0, 0, 0), 1.0F}, {Coord(0, 2000000000, 2000000000), 1.0F}});
  // With statistics in the file its metadata give the box, without them the tree does.
  for (const bool statistics : {true, false}) {
    EXPECT_THAT(message_of([&] { read_cloud_vdb(write_seekable({tile}, statistics)); }),
                HasSubstr("too large (68719476736 active voxels"));
    EXPECT_THAT(message_of([&] { read_cloud_vdb(write_seekable({box}, statistics)); }),
                HasSubstr("too large (a box of 1 x 2000000001 x 2000000001 cells"));
  }
}

TEST_F(VdbFile, TheMemoryLimitCounts) {
  const auto path = write_seekable({density_grid({{Coord(0, 0, 0), 1.0F}, {Coord(1, 0, 0), 1.0F}})});
  EXPECT_THAT(message_of([&] { read_cloud_vdb(path, {.memory_limit_bytes = 79}); }),
              HasSubstr("too large (2 active voxels"));
  EXPECT_EQ(read_cloud_vdb(path, {.memory_limit_bytes = 80}).active_voxels(), 2U);
}

TEST_F(VdbFile, LevelSetsAreNoDensities) {
  const auto grid = density_grid({{Coord(0, 0, 0), 1.0F}});
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  EXPECT_THAT(read_message({grid}), AllOf(HasSubstr("is a level set"), HasSubstr("vdb_tool -read " + file().string()),
                                          HasSubstr("-ls2fog -write fog.vdb")));
}

TEST_F(VdbFile, EmptyGridsAreErrors) {
  EXPECT_THAT(read_message({density_grid({})}), HasSubstr("is empty"));
  EXPECT_THAT(read_message({density_grid({{Coord(1, 2, 3), 0.0F}})}), HasSubstr("is empty"));
}

TEST_F(VdbFile, ImpossibleValuesNameTheirVoxel) {
  constexpr auto infinity = std::numeric_limits<float>::infinity();
  const auto message = [&](float value) {
    return read_message({density_grid({{Coord(0, 0, 0), 1.0F}, {Coord(-3, 40, 5), value}})});
  };
  EXPECT_THAT(message(std::nanf("")), HasSubstr("voxel (-3, 40, 5) has the value nan"));
  EXPECT_THAT(message(infinity), HasSubstr("voxel (-3, 40, 5) has the value inf"));
  EXPECT_THAT(message(-infinity), HasSubstr("voxel (-3, 40, 5) has the value -inf"));
  EXPECT_THAT(message(-1e-3F), HasSubstr("voxel (-3, 40, 5) has the value -0.001"));
}

TEST_F(VdbFile, AGridThatSharesAnothersVoxelsIsNamed) {
  const auto first = density_grid({{Coord(0, 0, 0), 1.0F}}, "first");
  const auto second = first->copy();  // shares the tree
  second->setName("density");
  EXPECT_THAT(read_message({first, second}), HasSubstr("it shares those of \"first\""));
  EXPECT_THAT(message_of([&] {
                read_cloud_vdb(write_stream({first, second}));
              }),
              HasSubstr("it shares those of \"first\""));
}

TEST_F(VdbFile, CompanionsComeInTheOrderOfTheCloud) {
  const auto cloud_grid =
      density_grid({{Coord(3, 0, 0), 1.0F}, {Coord(0, 1, 0), 2.0F}, {Coord(1, 0, 1), 3.0F}, {Coord(0, 0, 0), 0.0F}});
  auto albedo = density_grid(
      {{Coord(3, 0, 0), 0.1F}, {Coord(0, 1, 0), 0.0F}, {Coord(1, 0, 1), 0.3F}, {Coord(9, 9, 9), 7.0F}}, "albedo");
  const auto path = write_seekable({cloud_grid, albedo});
  const CloudField cloud = read_cloud_vdb(path);
  EXPECT_THAT(read_auxiliary_vdb(path, cloud, {.grid = "albedo"}, 0, 1), ElementsAre(0.1F, 0.0F, 0.3F));
  EXPECT_THAT(message_of([&] { read_auxiliary_vdb(path, cloud, {.grid = "albedo"}, 0.05, 1); }),
              HasSubstr("grid \"albedo\": voxel (0, 1, 0) has the value 0 (0.05 to 1 are allowed)"));

  const VdbReadOptions transposed{.up_axis = "y", .voxel_size_m = std::array<double, 3>{2, 3, 4}};
  auto turned_albedo = transposed;
  turned_albedo.grid = "albedo";
  const CloudField turned_cloud = read_cloud_vdb(path, transposed);
  EXPECT_THAT(turned_cloud.value, ElementsAre(3, 1, 2));
  EXPECT_THAT(read_auxiliary_vdb(path, turned_cloud, turned_albedo, 0, 1), ElementsAre(0.3F, 0.1F, 0.0F));
}

TEST_F(VdbFile, CompanionsAreWhatTheirMetadataSay) {
  const auto cloud_grid = density_grid({{Coord(3, 0, 0), 1.0F}});
  const auto other = density_grid({{Coord(3, 0, 0), 0.5F}}, "other");
  const auto read = [&](const std::string& wanted) {
    const auto path = write_seekable({cloud_grid, other});
    return read_auxiliary_vdb(path, read_cloud_vdb(path), {.grid = "other", .auxiliary_quantity = wanted}, 0, 1);
  };
  EXPECT_THAT(read("single_scattering_albedo"), ElementsAre(0.5F));  // the file does not say
  other->insertMeta("quantity", openvdb::StringMetadata("effective_radius"));
  EXPECT_THAT(read(""), ElementsAre(0.5F));
  EXPECT_THAT(read("effective_radius"), ElementsAre(0.5F));
  EXPECT_THAT(message_of([&] { read("single_scattering_albedo"); }),
              AllOf(HasSubstr("grid \"other\""), HasSubstr("found the quantity effective_radius"),
                    HasSubstr("allowed single_scattering_albedo")));
}

TEST_F(VdbFile, CompanionsThatDoNotFitAreErrors) {
  const auto cloud_grid = density_grid({{Coord(3, 0, 0), 1.0F}, {Coord(0, 1, 0), 2.0F}});
  const auto partial = [&](float background) {
    auto grid = FloatGrid::create(background);
    grid->setName("albedo");
    grid->tree().setValueOn(Coord(3, 0, 0), 0.9F);
    return grid;
  };
  const auto read = [&](const FloatGrid::Ptr& grid) {
    const auto path = write_seekable({cloud_grid, grid});
    return read_auxiliary_vdb(path, read_cloud_vdb(path), {.grid = "albedo"}, 0, 1);
  };
  EXPECT_THAT(message_of([&] { read(partial(0)); }), HasSubstr("voxel (0, 1, 0) has no value"));
  EXPECT_THAT(read(partial(0.5F)), ElementsAre(0.9F, 0.5F));

  const auto nan = partial(1);
  nan->tree().setValueOn(Coord(0, 1, 0), std::nanf(""));
  EXPECT_THAT(message_of([&] { read(nan); }), HasSubstr("voxel (0, 1, 0) has the value nan"));

  const auto shifted = partial(1);
  shifted->setTransform(openvdb::math::Transform::createLinearTransform(
      openvdb::Mat4d(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.5, 0.0, 1.0)));
  EXPECT_THAT(message_of([&] { read(shifted); }), HasSubstr("its voxels are not those of the cloud (along y"));
  const auto finer = partial(1);
  finer->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
  EXPECT_THAT(message_of([&] { read(finer); }), HasSubstr("its voxels are not those of the cloud (along x"));
}

}  // namespace
}  // namespace cloudbow
