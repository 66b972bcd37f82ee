// Grids of a file, and files that are damaged or none. Truth: one message that names the file and the remedy.
#include <gmock/gmock.h>
#include <openvdb/openvdb.h>

#include <fstream>
#include <functional>
#include <iterator>

#include "vdb_test_tools.hpp"

namespace cloudbow {
namespace {

using openvdb::Coord;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

namespace fs = std::filesystem;

TEST_F(VdbFile, GridsOfOneNameAreToldApartByNumber) {
  const openvdb::GridPtrVec twins{density_grid({{Coord(0, 0, 0), 1.0F}}), density_grid({{Coord(0, 0, 0), 2.0F}})};
  EXPECT_THAT(read_message(twins), HasSubstr("several have this name: choose one of \"density[0]\", \"density[1]\""));
  EXPECT_THAT(read_cloud_vdb(file(), {.grid = "density[1]"}).value, ElementsAre(2.0F));
}

TEST_F(VdbFile, FilesOfOtherKindsPointToTheImport) {
  std::ofstream(file("les.nc"), std::ios::binary) << "\x89HDF\r\n\x1a\n and more";
  EXPECT_THAT(
      message_of([&] { read_cloud_vdb(file("les.nc")); }),
      AllOf(HasSubstr("HDF5 or netCDF-4"), HasSubstr("cloudbow cloud import"), HasSubstr("les.nc -o cloud.vdb")));
  std::ofstream(file("old.nc"), std::ios::binary) << "CDF\x01 and more";
  EXPECT_THAT(message_of([&] { read_cloud_vdb(file("old.nc")); }),
              AllOf(HasSubstr("those of netCDF)"), HasSubstr("cloudbow cloud import")));
}

TEST_F(VdbFile, WhatIsNoFileIsToldApart) {
  EXPECT_THAT(message_of([&] { read_cloud_vdb(file("none.vdb")); }),
              HasSubstr("none.vdb: can't be read (found no such file"));
  EXPECT_THAT(message_of([&] { read_cloud_vdb(folder_); }), HasSubstr("found a directory"));
  std::ofstream(file("text.vdb")) << "this is a text and no cloud";
  EXPECT_THAT(message_of([&] { read_cloud_vdb(file("text.vdb")); }),
              testing::ContainsRegex("not an OpenVDB file .*\\); `cloudbow cloud import"));
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

}  // namespace
}  // namespace cloudbow
