// Functions that the tests of VDB files share.
#pragma once

#include <gmock/gmock.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "cloud_test_tools.hpp"
#include "cloudbow/medium/vdb_file.hpp"

namespace cloudbow {

/// A folder of its own for each test, removed afterwards.
class VdbFile : public testing::Test {
 protected:
  VdbFile() {
    openvdb::initialize();
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("cloudbow_" + std::string(test->name()) + "_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~VdbFile() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path file(const std::string& name = "cloud.vdb") const { return folder_ / name; }

  /// io::File writes offsets that let a reader skip grids, io::Stream does not: reading has to cope with both.
  std::filesystem::path write_seekable(const openvdb::GridPtrVec& grids, bool statistics = true) const {
    openvdb::io::File output(file().string());
    output.setGridStatsMetadataEnabled(statistics);
    output.write(grids);
    return file();
  }
  std::filesystem::path write_stream(const openvdb::GridPtrVec& grids, bool statistics = true) const {
    std::ofstream output(file(), std::ios::binary);
    openvdb::io::Stream stream(output);
    stream.setGridStatsMetadataEnabled(statistics);
    stream.write(grids);
    return file();
  }

  std::string read_message(const openvdb::GridPtrVec& grids, const VdbReadOptions& options = {}) const {
    const auto path = write_seekable(grids);
    const auto message = message_of([&] { read_cloud_vdb(path, options); });
    EXPECT_THAT(message, testing::HasSubstr(path.string()));
    return message;
  }

  std::filesystem::path folder_;
};

inline openvdb::FloatGrid::Ptr density_grid(const std::vector<std::pair<openvdb::Coord, float>>& voxels,
                                            const std::string& name = "density") {
  auto grid = openvdb::FloatGrid::create(0.0F);
  grid->setName(name);
  for (const auto& [index, value] : voxels) grid->tree().setValueOn(index, value);
  return grid;
}

inline openvdb::FloatGrid::Ptr with_transform(openvdb::FloatGrid::Ptr grid,
                                              const openvdb::math::Transform::Ptr& transform) {
  grid->setTransform(transform);
  return grid;
}

inline openvdb::FloatGrid::Ptr with_matrix(const openvdb::Mat4d& matrix) {
  return with_transform(density_grid({{openvdb::Coord(0, 0, 0), 1.0F}}),
                        openvdb::math::Transform::createLinearTransform(matrix));
}

inline CloudField small_field() {
  return make_cloud_field({5, 3, 2}, {20, 30, 12.5}, {-7, 11, 400}, {0, 0.1F, 0.2F,  0, 0.3F,  //
                                                                     0, 0,    0,     0, 0,     //
                                                                     1, 0,    0,     0, 2,     //
                                                                     0, 0,    0,     0, 0,     //
                                                                     3, 3,    3,     3, 3,     //
                                                                     0, 0,    1e-9F, 0, 0},
                          "extinction");
}

}  // namespace cloudbow
