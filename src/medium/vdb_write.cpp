#include "vdb_write.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <unistd.h>

#include <cassert>
#include <cmath>
#include <fstream>
#include <system_error>

#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/vdb_file.hpp"

namespace cloudbow {

namespace {

constexpr float largest_half = 65504.0F;

/// What tells a grid from the others on the same voxels.
struct GridContent {
  const std::string& name;
  const std::string& quantity;
  const std::string& units;
  const std::vector<float>& value;
  bool half;
};

openvdb::FloatGrid::Ptr to_grid(const CloudField& field, const GridContent& content) {
  const auto grid = openvdb::FloatGrid::create(0.0F);
  auto accessor = grid->getAccessor();
  std::size_t row = 0;
  for (int k = 0; k < field.cells[2]; ++k) {
    for (int j = 0; j < field.cells[1]; ++j, ++row) {
      for (auto s = field.row_begin[row]; s < field.row_begin[row + 1]; ++s) {
        const auto& span = field.spans[s];
        for (int i = 0; i < span.n; ++i) {
          const float value = content.value[span.offset + static_cast<std::size_t>(i)];
          if (content.half && value > largest_half) {
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
  grid->setName(content.name);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  grid->setSaveFloatAsHalf(content.half);
  grid->setCreator("cloudbow");
  grid->insertMeta("domain_min_m", openvdb::Vec3DMetadata(min));
  grid->insertMeta("domain_max_m", openvdb::Vec3DMetadata(max));
  if (!content.quantity.empty()) grid->insertMeta("quantity", openvdb::StringMetadata(content.quantity));
  if (!content.units.empty()) grid->insertMeta("units", openvdb::StringMetadata(content.units));
  return grid;
}

std::string units_of(const std::string& quantity) {
  if (quantity == "extinction") return "1/m";
  if (quantity == "liquid_water_content") return "g/m3";
  return "";
}

void write(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids) {
  std::ofstream stream;
  stream.exceptions(std::ios::failbit | std::ios::badbit);
  stream.open(path, std::ios::binary | std::ios::trunc);
  openvdb::io::Stream archive(stream);
  archive.setCompression(openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
  archive.write(grids);
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

void vdb::write_cloud(const std::filesystem::path& path, const CloudField& field, const VdbWriteOptions& options,
                      const std::vector<VdbCompanion>& companions) {
  openvdb::initialize();
  const std::string units = units_of(field.quantity);
  openvdb::GridCPtrVec grids{to_grid(field, {options.grid, field.quantity, units, field.value, options.half})};
  for (const VdbCompanion& companion : companions) {
    assert(companion.value.size() == field.value.size());
    grids.push_back(to_grid(field, {companion.grid, companion.quantity, companion.units, companion.value, false}));
  }
  auto part = path;
  part += fmt::format(".{}.part", getpid());
  try {
    write(part, grids);
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
