#include <gmock/gmock.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
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

CloudField small_field() {
  return make_cloud_field({5, 3, 2}, {20, 30, 12.5}, {-7, 11, 400}, {0, 0.1F, 0.2F,  0, 0.3F,  //
                                                                     0, 0,    0,     0, 0,     //
                                                                     1, 0,    0,     0, 2,     //
                                                                     0, 0,    0,     0, 0,     //
                                                                     3, 3,    3,     3, 3,     //
                                                                     0, 0,    1e-9F, 0, 0},
                          "extinction");
}

TEST_F(VdbFile, WhatIsWrittenIsRead) {
  const CloudField field = small_field();
  write_cloud_vdb(file(), field);
  const CloudField read = read_cloud_vdb(file());
  EXPECT_EQ(read.cells, field.cells);
  EXPECT_EQ(read.cell_size_m, field.cell_size_m);
  EXPECT_EQ(read.min_m, field.min_m);
  EXPECT_EQ(read.value, field.value);
  EXPECT_EQ(read.row_begin, field.row_begin);
  EXPECT_EQ(read.quantity, "extinction");
  EXPECT_EQ(to_dense(read), to_dense(field));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1) << "nothing but the file itself may be left";
}

TEST_F(VdbFile, HalfKeepsElevenBits) {
  const CloudField field =
      make_cloud_field({3, 1, 1}, {1, 1, 1}, {0, 0, 0}, {0.0123F, 1.7F, 65504.0F}, "liquid_water_content");
  write_cloud_vdb(file(), field, {.grid = "lwc", .half = true});
  const CloudField read = read_cloud_vdb(file(), {.grid = "lwc"});
  EXPECT_EQ(read.quantity, "liquid_water_content");
  ASSERT_EQ(read.value.size(), 3U);
  for (std::size_t n = 0; n < 3; ++n) EXPECT_NEAR(read.value[n], field.value[n], 0x1p-11 * field.value[n]);
  EXPECT_EQ(describe_cloud_vdb(file()).grids.at(0).type, "float stored as half");
}

TEST_F(VdbFile, ValuesTooLargeForHalfAreNotWritten) {
  const CloudField field = make_cloud_field({2, 1, 1}, {1, 1, 1}, {0, 0, 0}, {1, 1e5F}, "");
  EXPECT_THAT(message_of([&] { write_cloud_vdb(file(), field, {.half = true}); }),
              HasSubstr("voxel (1, 0, 0) has the value 100000"));
  EXPECT_FALSE(fs::exists(file()));
}

TEST_F(VdbFile, WritingIntoNothingIsAnError) {
  EXPECT_THAT(message_of([&] { write_cloud_vdb(file("no/such/folder.vdb"), small_field()); }),
              AllOf(HasSubstr("can't be written"), HasSubstr("there is no folder")));
  fs::create_directory(file("taken"));
  EXPECT_THAT(message_of([&] { write_cloud_vdb(file("taken"), small_field()); }), HasSubstr("can't be written"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
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

TEST_F(VdbFile, WhatIsNoFileIsToldApart) {
  EXPECT_THAT(message_of([&] { read_cloud_vdb(file("none.vdb")); }),
              HasSubstr("none.vdb: can't be read (found no such file"));
  EXPECT_THAT(message_of([&] { read_cloud_vdb(folder_); }), HasSubstr("found a directory"));
  std::ofstream(file("text.vdb")) << "this is a text and no cloud";
  EXPECT_THAT(message_of([&] { read_cloud_vdb(file("text.vdb")); }), HasSubstr("not an OpenVDB file"));
  std::ofstream(file("empty.vdb")).flush();
  EXPECT_THAT(message_of([&] { read_cloud_vdb(file("empty.vdb")); }), HasSubstr("not an OpenVDB file"));
}

TEST_F(VdbFile, EveryTruncationIsNoticed) {
  std::vector<std::pair<Coord, float>> voxels;
  for (int n = 0; n < 3000; ++n)
    voxels.push_back({Coord(n % 20, n / 20 % 15, n / 300), 1.0F + static_cast<float>(n % 7)});
  const auto second = density_grid(voxels, "second");
  second->setSaveFloatAsHalf(true);
  const openvdb::GridPtrVec grids = {density_grid(voxels), second};
  const std::vector<std::function<fs::path()>> writers = {[&] { return write_seekable(grids); },
                                                          [&] { return write_stream(grids); }};
  for (const auto& writer : writers) {
    const auto path = writer();
    const auto bytes = fs::file_size(path);
    ASSERT_GT(bytes, 2000U);
    ASSERT_EQ(read_cloud_vdb(path).active_voxels(), 3000U);
    for (std::uintmax_t cut = 1; cut < bytes; cut += cut < 12 ? 1 : 97) {
      fs::resize_file(path, bytes - cut);
      EXPECT_THROW(read_cloud_vdb(path), InputError) << cut << " bytes cut off";
    }
  }
}

TEST_F(VdbFile, DamageEndsInAFieldOrAnError) {
  write_cloud_vdb(file(), small_field());
  std::ifstream input(file(), std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(input)), {});
  std::uint32_t state = 1;
  const auto random = [&](std::size_t below) {  // a linear congruential generator: the same damage everywhere
    state = state * 1664525U + 1013904223U;
    return (state >> 8U) % below;
  };
  for (int n = 0; n < 60; ++n) {
    std::string damaged = whole;
    for (int byte = 0; byte < 3; ++byte) damaged[random(1200)] = static_cast<char>(random(256));
    std::ofstream(file(), std::ios::binary) << damaged;
    try {
      EXPECT_GT(read_cloud_vdb(file()).active_voxels(), 0U);
    } catch (const InputError&) {
    }
  }
}

TEST_F(VdbFile, TruncationIsNamed) {
  write_cloud_vdb(file(), small_field());
  fs::resize_file(file(), fs::file_size(file()) - 1);
  EXPECT_THAT(message_of([&] { read_cloud_vdb(file()); }), HasSubstr("truncated or damaged"));
}

TEST_F(VdbFile, AMissingGridListsThoseThere) {
  const auto velocity = openvdb::Vec3SGrid::create();
  velocity->setName("velocity");
  const auto temperature = openvdb::DoubleGrid::create();
  temperature->setName("temperature");
  const openvdb::GridPtrVec grids = {density_grid({{Coord(0, 0, 0), 1.0F}}, "smoke"), velocity, temperature};
  EXPECT_THAT(read_message(grids), HasSubstr("no grid \"density\" (grids in the file: \"smoke\" (float), \"velocity\" "
                                             "(Tree_vec3s_5_4_3), \"temperature\" (double))"));
  EXPECT_EQ(read_cloud_vdb(file(), {.grid = "smoke"}).active_voxels(), 1U);
  EXPECT_EQ(read_cloud_vdb(write_stream(grids), {.grid = "smoke"}).active_voxels(), 1U);
  EXPECT_THAT(read_message({}), HasSubstr("the file holds no grid"));
}

TEST_F(VdbFile, OtherTypesAreNamed) {
  const auto twice = openvdb::DoubleGrid::create();
  twice->setName("density");
  EXPECT_THAT(read_message({twice}), HasSubstr("wrong type (double; float"));
  const auto whole = openvdb::Int32Grid::create();
  whole->setName("density");
  EXPECT_THAT(read_message({whole}), HasSubstr("wrong type (Tree_int32_5_4_3; float"));
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

/// Fields of the literature, outside the project: $CLOUDBOW_REFERENCE_DIR/fields.
class ReferenceFields : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("CLOUDBOW_REFERENCE_DIR");
    if (folder == nullptr) GTEST_SKIP() << "CLOUDBOW_REFERENCE_DIR is not set";
    fields_ = fs::path(folder) / "fields";
  }
  fs::path fields_;
};

TEST_F(ReferenceFields, Rico) {
  const CloudField field = read_cloud_vdb(fields_ / "rico32.vdb");
  EXPECT_THAT(field.cells, ElementsAre(32, 37, 38));
  EXPECT_THAT(field.cell_size_m, ElementsAre(20, 20, 40));
  EXPECT_EQ(field.min_m[2], -20);
  EXPECT_EQ(field.active_voxels(), 3943U);
}

TEST_F(ReferenceFields, StepCloud) {
  const auto depths = column_depths(read_cloud_vdb(fields_ / "step_cloud.vdb"));
  ASSERT_EQ(depths.size(), 32U);
  for (std::size_t i = 0; i < 32; ++i) EXPECT_NEAR(depths[i], i < 16 ? 2 : 18, 1e-5);  // 32-bit values
}

TEST_F(ReferenceFields, LandsatHasTheOpticalDepthsOfItsTable) {
  const CloudField field = read_cloud_vdb(fields_ / "landsat.vdb");
  EXPECT_THAT(field.cells, ElementsAre(128, 128, 119));
  EXPECT_EQ(field.active_voxels(), 1261003U);
  std::ifstream table(fields_.parent_path() / "i3rc" / "landsat_optical_depth.csv");
  ASSERT_TRUE(table) << "the table of optical depths is missing";
  std::vector<double> expected;
  for (std::string line; std::getline(table, line);) {
    if (line.empty() || line[0] == '#' || std::isalpha(static_cast<unsigned char>(line[0])) != 0) continue;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) expected.push_back(std::stod(cell));
  }
  const auto depths = column_depths(field);
  ASSERT_EQ(expected.size(), depths.size());
  for (std::size_t n = 0; n < depths.size(); ++n)
    ASSERT_NEAR(depths[n], expected[n], 1e-5 * (1 + expected[n])) << "column " << n;
}

TEST_F(ReferenceFields, StratocumulusHasItsAlbedoVoxelByVoxel) {
  const auto path = fields_ / "stcu213.vdb";
  const CloudField cloud = read_cloud_vdb(path);
  EXPECT_THAT(cloud.cells, ElementsAre(64, 64, 16));
  const auto albedo = read_auxiliary_vdb(path, cloud, {.grid = "single_scattering_albedo"}, 0, 1);
  ASSERT_EQ(albedo.size(), cloud.active_voxels());
  EXPECT_GT(*std::min_element(albedo.begin(), albedo.end()), 0.9F);
}

}  // namespace
}  // namespace cloudbow
