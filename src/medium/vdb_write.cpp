#include "vdb_write.hpp"

#include <fmt/format.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/Stream.h>
#include <openvdb/io/io.h>
#include <openvdb/openvdb.h>

#include <cassert>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <new>
#include <optional>
#include <system_error>

#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/vdb_file.hpp"

namespace cloudbow {

namespace {

constexpr float largest_half = 65504.0F;

/// Properties that distinguish a grid from the others on the same voxels.
struct GridContent {
  const std::string& name;
  const std::string& quantity;
  const std::string& units;
  const std::vector<float>& value;
  bool half;
};

/// Box and centres of the voxels. OpenVDB takes voxels of less than 3e-15 m3 for singular.
void set_transform(openvdb::FloatGrid& grid, const VdbBox& box) {
  constexpr double smallest_volume = 3e-15;
  const auto [dx, dy, dz] = box.cell_size_m;
  if (!(dx * dy * dz >= smallest_volume)) {
    throw InputError(fmt::format(
        "voxel size: too small for an OpenVDB file (found {:g} x {:g} x {:g} m, allowed voxels of {:g} m3 at least)",
        dx, dy, dz, smallest_volume));
  }
  openvdb::Vec3d size;
  openvdb::Vec3d min;
  openvdb::Vec3d max;
  for (int a = 0; a < 3; ++a) {
    size[a] = box.cell_size_m[a];
    min[a] = box.min_m[a];
    max[a] = box.min_m[a] + box.cells[a] * box.cell_size_m[a];
  }
  grid.setTransform(openvdb::math::Transform::Ptr(new openvdb::math::Transform(
      openvdb::math::MapBase::Ptr(new openvdb::math::ScaleTranslateMap(size, min + 0.5 * size)))));
  grid.insertMeta("domain_min_m", openvdb::Vec3DMetadata(min));
  grid.insertMeta("domain_max_m", openvdb::Vec3DMetadata(max));
}

void set_metadata(openvdb::FloatGrid& grid, const std::string& name, const std::string& quantity,
                  const std::string& units) {
  grid.setName(name);
  grid.setGridClass(openvdb::GRID_FOG_VOLUME);
  grid.setCreator("cloudbow");
  if (!quantity.empty()) grid.insertMeta("quantity", openvdb::StringMetadata(quantity));
  if (!units.empty()) grid.insertMeta("units", openvdb::StringMetadata(units));
}

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

  set_transform(*grid, {field.cells, field.cell_size_m, field.min_m});
  set_metadata(*grid, content.name, content.quantity, content.units);
  grid->setSaveFloatAsHalf(content.half);
  return grid;
}

openvdb::FloatGrid::ConstPtr to_grid(const VdbField& field, const VdbBox& box) {
  assert(field.voxel.size() == field.value.size());
  const auto grid = openvdb::FloatGrid::create(0.0F);
  auto accessor = grid->getAccessor();
  for (std::size_t n = 0; n < field.voxel.size(); ++n) {
    const auto& [i, j, k] = field.voxel[n];
    accessor.setValue({i, j, k}, field.value[n]);
  }
  set_transform(*grid, box);
  set_metadata(*grid, field.grid, field.quantity, field.units);
  if (field.direction) {
    const auto& [x, y, z] = *field.direction;
    grid->insertMeta("direction", openvdb::Vec3DMetadata(openvdb::Vec3d(x, y, z)));
  }
  return grid;
}

std::string units_of(const std::string& quantity) {
  if (quantity == "extinction") return "1/m";
  if (quantity.ends_with("_water_content")) return "g/m3";
  if (quantity == "temperature") return "K";
  return "";
}

constexpr std::uint32_t compression_flags = openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK;

/// Grids one by one: openvdb::io::File and Stream require them all at once. The order of the writes is that of
/// openvdb::io::Archive::write.
class GridByGrid : private openvdb::io::Archive {
 public:
  GridByGrid(std::ostream& stream, std::size_t count) : stream_(stream) {
    setCompression(compression_flags);
    openvdb::io::setStreamMetadataPtr(stream_, stream_metadata_, /*transfer=*/false);
    writeHeader(stream_, /*seekable=*/true);
    openvdb::MetaMap().writeMeta(stream_);
    const auto grids = static_cast<std::int32_t>(count);
    stream_.write(reinterpret_cast<const char*>(&grids), sizeof grids);
  }
  ~GridByGrid() override { openvdb::io::clearStreamMetadataPtr(stream_); }
  GridByGrid(const GridByGrid&) = delete;
  GridByGrid& operator=(const GridByGrid&) = delete;

  void add(const openvdb::FloatGrid::ConstPtr& grid) {
    openvdb::io::GridDescriptor descriptor(grid->getName(), grid->type());
    writeGrid(descriptor, grid, stream_, /*seekable=*/true);
  }

 private:
  std::ostream& stream_;
  openvdb::io::StreamMetadata::Ptr stream_metadata_{new openvdb::io::StreamMetadata};
};

/// A stream into a file that appears when it is complete, with the user's messages of what goes wrong.
class PartFile {
 public:
  explicit PartFile(const std::filesystem::path& target) : target_(target), file_(target) {
    doing([&] {
      stream_.exceptions(std::ios::failbit | std::ios::badbit);
      stream_.open(file_.temporary(), std::ios::binary | std::ios::trunc);
    });
  }

  std::ostream& stream() { return stream_; }

  /// Calls a function that writes, and turns its exceptions into messages for the user.
  template <class Function>
  void doing(Function function) {
    try {
      errno = 0;
      function();
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      const int reason = errno;
      throw InputError(
          fmt::format("{}: cannot be written ({}); name a file in a folder that exists, is writable and has room",
                      target_.string(), reason != 0 ? std::generic_category().message(reason) : error.what()));
    }
  }

  void commit() {
    doing([&] { stream_.close(); });
    file_.commit();
  }

 private:
  std::filesystem::path target_;
  AtomicFile file_;
  std::ofstream stream_;
};

}  // namespace

void vdb::write_cloud(const std::filesystem::path& path, const CloudField& field, const VdbWriteOptions& options,
                      const std::vector<VdbAuxiliary>& auxiliaries, const std::vector<VdbCloudGrid>& others) {
  openvdb::initialize();
  openvdb::GridCPtrVec grids;
  const auto add = [&grids](const std::string& name, const CloudField& of, bool half,
                            const std::vector<VdbAuxiliary>& on_its_voxels) {
    grids.push_back(to_grid(of, {name, of.quantity, units_of(of.quantity), of.value, half}));
    for (const VdbAuxiliary& auxiliary : on_its_voxels) {
      assert(auxiliary.value.size() == of.value.size());
      grids.push_back(to_grid(of, {auxiliary.grid, auxiliary.quantity, auxiliary.units, auxiliary.value, false}));
    }
  };
  add(options.grid, field, options.half, auxiliaries);
  // A temperature of 16 bits would be off by a tenth of a kelvin.
  for (const VdbCloudGrid& other : others)
    add(other.grid, other.field, options.half && other.field.quantity != "temperature", other.auxiliaries);
  PartFile file(path);
  file.doing([&] {
    openvdb::io::Stream archive(file.stream());
    archive.setCompression(compression_flags);
    archive.write(grids);
  });
  file.commit();
}

void vdb::write_fields(const std::filesystem::path& path, const VdbBox& box, std::size_t count,
                       const std::function<VdbField(std::size_t)>& field) {
  openvdb::initialize();
  PartFile file(path);
  std::optional<GridByGrid> archive;
  file.doing([&] { archive.emplace(file.stream(), count); });
  for (std::size_t n = 0; n < count; ++n) {
    const auto grid = to_grid(field(n), box);
    file.doing([&] { archive->add(grid); });
  }
  archive.reset();
  file.commit();
}

}  // namespace cloudbow
