#include <fcntl.h>
#include <fmt/format.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <system_error>

#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/vdb_file.hpp"

namespace cloudbow {

namespace {

constexpr float largest_half = 65504.0F;

openvdb::FloatGrid::Ptr to_grid(const CloudField& field, const VdbWriteOptions& options) {
  const auto grid = openvdb::FloatGrid::create(0.0F);
  auto accessor = grid->getAccessor();
  std::size_t row = 0;
  for (int k = 0; k < field.cells[2]; ++k) {
    for (int j = 0; j < field.cells[1]; ++j, ++row) {
      for (auto s = field.row_begin[row]; s < field.row_begin[row + 1]; ++s) {
        const auto& span = field.spans[s];
        for (int i = 0; i < span.n; ++i) {
          const float value = field.value[span.offset + static_cast<std::size_t>(i)];
          if (options.half && value > largest_half) {
            throw InputError(fmt::format(
                "cloud field: voxel ({}, {}, {}) has the value {} (up to {} fits into half) write it as float",
                span.i + i, j, k, value, largest_half));
          }
          accessor.setValue({span.i + i, j, k}, value);
        }
      }
    }
  }

  openvdb::Vec3d size;
  openvdb::Vec3d min;
  openvdb::Vec3d max;
  for (int a = 0; a < 3; ++a) {
    size[a] = field.cell_size_m[a];
    min[a] = field.min_m[a];
    max[a] = field.max_m(a);
  }
  grid->setTransform(openvdb::math::Transform::Ptr(new openvdb::math::Transform(
      openvdb::math::MapBase::Ptr(new openvdb::math::ScaleTranslateMap(size, min + 0.5 * size)))));
  grid->setName(options.grid);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  grid->setSaveFloatAsHalf(options.half);
  grid->setCreator("cloudbow");
  grid->insertMeta("domain_min_m", openvdb::Vec3DMetadata(min));
  grid->insertMeta("domain_max_m", openvdb::Vec3DMetadata(max));
  if (!field.quantity.empty()) grid->insertMeta("quantity", openvdb::StringMetadata(field.quantity));
  if (field.quantity == "extinction") grid->insertMeta("units", openvdb::StringMetadata("1/m"));
  if (field.quantity == "liquid_water_content") grid->insertMeta("units", openvdb::StringMetadata("g/m3"));
  return grid;
}

void write(const std::filesystem::path& path, const openvdb::FloatGrid::ConstPtr& grid) {
  std::ofstream stream;
  stream.exceptions(std::ios::failbit | std::ios::badbit);
  stream.open(path, std::ios::binary | std::ios::trunc);
  openvdb::io::Stream archive(stream);
  archive.setCompression(openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
  archive.write(openvdb::GridCPtrVec{grid});
  stream.close();
}

/// Without this a crash of the machine after the rename can leave an empty file under the final name.
void flush_to_disk(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool failed = file < 0 || fsync(file) != 0;
  if (file >= 0) close(file);
  if (failed) throw std::ios_base::failure("fsync", std::error_code(errno, std::generic_category()));
}

}  // namespace

void write_cloud_vdb(const std::filesystem::path& path, const CloudField& field, const VdbWriteOptions& options) {
  openvdb::initialize();
  const auto grid = to_grid(field, options);
  auto part = path;
  part += fmt::format(".{}.part", getpid());
  try {
    write(part, grid);
    flush_to_disk(part);
    std::filesystem::rename(part, path);
  } catch (const std::exception&) {
    const std::error_code reason(errno, std::generic_category());
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw InputError(
        fmt::format("{}: cannot be written ({}) name a file in a folder that exists, is writable and has room",
                    path.string(), reason.message()));
  }
}

}  // namespace cloudbow
