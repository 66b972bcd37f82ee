#include "cloudbow/medium/vdb_file.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <thread>
#include <utility>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/file_library_lock.hpp"
#include "cloudbow/core/module.hpp"
#include "cloudbow/core/sanitizers.hpp"
#include "cloudbow/medium/cloud_amounts.hpp"
#include "cloudbow/medium/plausibility.hpp"
#include "vdb_module.hpp"
#include "vdb_plain_file.hpp"
#include "vdb_read.hpp"

namespace cloudbow {

namespace {

/// It stays loaded: OpenVDB's threads outlive any call.
const VdbModule& vdb_module() {
  static const VdbModule& module = []() -> const VdbModule& {
    // The libraries take 65 MB, and reading a small file some more. OpenVDB's log starts threads as it is loaded.
    // It has 60,000 symbols to find. In its own libraries first, that takes 30 ms; in those of the program first, 55.
    const void* const symbol = load_module("cloudbow_vdb.so", "cloudbow_vdb_module",
                                           {"OpenVDB", "reads and writes OpenVDB files", 100'000'000, 4, true});
    // The address sanitizer's allocator, unlike the C library's, is not kept consistent over a fork. So the threads
    // that OpenVDB's log has just started must be idle before the first read in a sandbox.
    if constexpr (has_address_sanitizer) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return *static_cast<const VdbModule*>(symbol);
  }();
  return module;
}

}  // namespace

VdbGrid read_grid_by_openvdb(const std::filesystem::path& path, const std::string& grid, std::uint64_t,
                             const VdbGridChecks& checks) {
  const FileLibraryLock lock;
  return vdb_module().read_grid(path, grid, checks);
}

VdbGrid read_grid(const std::filesystem::path& path, const std::string& grid, std::uint64_t memory_bytes,
                  const VdbGridChecks& checks) {
  std::optional<VdbGrid> plain = read_plain_vdb(path, grid, memory_bytes);
  if (!plain) return read_grid_by_openvdb(path, grid, memory_bytes, checks);
  checks.header(plain->header);
  checks.voxels(static_cast<double>(plain->active_voxels()));
  return std::move(*plain);
}

VdbCloud read_cloud_vdb(const std::filesystem::path& path, const VdbReadOptions& options) {
  return read_cloud(read_grid, path, options);
}

std::vector<float> read_auxiliary_vdb(const std::filesystem::path& path, const CloudField& cloud,
                                      const VdbReadOptions& options, double lowest, double highest) {
  return read_auxiliary(read_grid, path, cloud, options, lowest, highest);
}

namespace {

/// Whether the grid describes the voxels of another one.
bool is_auxiliary(const std::string& quantity) {
  return quantity == "effective_radius" || quantity == "single_scattering_albedo" || quantity == "phase_index" ||
         quantity == "temperature";
}

/// Optical depth of a grid of liquid water, by the radii of another grid.
void add_optical_depth(const std::filesystem::path& path, const std::string& radius_grid, const std::string& up_axis,
                       VdbGridInfo& water) {
  VdbCloud field = read_cloud_vdb(path, {.grid = water.name, .up_axis = up_axis});
  const std::vector<float> radius = read_auxiliary_vdb(path, field, {.grid = radius_grid, .up_axis = up_axis},
                                                       smallest_effective_radius_um, largest_effective_radius_um);
  water_to_extinction_by_radius(field, radius);
  const CloudSummary summary = summarize(field);
  water.optical_depth = summary.column;
  water.largest_voxel_depth = summary.value.max * field.cell_size_m[2];
}

}  // namespace

namespace {

/// Leaves the grid of this name.
void keep_one(CloudInfo& info, const std::string& name) {
  std::string there;
  for (const VdbGridInfo& grid : info.grids) there += (there.empty() ? "\"" : ", \"") + grid.name + "\"";
  std::erase_if(info.grids, [&name](const VdbGridInfo& grid) { return grid.name != name; });
  if (info.grids.empty()) {
    throw InputError(fmt::format("{}: no grid \"{}\" (found {}) name one of these", info.path.string(), name, there));
  }
}

}  // namespace

CloudInfo describe_cloud_vdb(const std::filesystem::path& path, const std::string& grid_name,
                             const std::string& up_axis) {
  const FileLibraryLock lock;
  CloudInfo info{.path = path, .bytes = 0, .grids = vdb_module().list_grids(path)};
  info.bytes = std::filesystem::file_size(path);
  if (!grid_name.empty()) keep_one(info, grid_name);
  const VdbGridInfo* radius = nullptr;
  for (auto& grid : info.grids) {
    try {
      VdbReadOptions options;
      options.grid = grid.name;
      options.up_axis = up_axis;
      options.ignores_background = is_auxiliary(grid.quantity);
      const VdbCloud cloud = read_cloud_vdb(path, options);
      grid.cloud = summarize(cloud);
      grid.cloud->notes = cloud.notes;
      if (grid.quantity == "extinction") grid.largest_voxel_depth = grid.cloud->value.max * grid.cloud->cell_size_m[2];
      // Radii of ice and other species are not those of droplets.
      if (grid.quantity == "effective_radius" && !grid.name.starts_with("reff_") && radius == nullptr) radius = &grid;
    } catch (const InputError& error) {
      grid.reason = error.what();
    }
  }
  for (auto& grid : info.grids) {
    if (!grid.cloud || grid.quantity != "liquid_water_content" || radius == nullptr) continue;
    try {
      add_optical_depth(path, radius->name, up_axis, grid);
    } catch (const InputError&) {  // radii of other voxels, or none that a cloud has: the water path stands alone
    }
  }
  return info;
}

void write_cloud_vdb(const std::filesystem::path& path, const CloudField& field, const VdbWriteOptions& options,
                     const std::vector<VdbAuxiliary>& auxiliaries, const std::vector<VdbCloudGrid>& others) {
  const FileLibraryLock lock;
  vdb_module().write_cloud(path, field, options, auxiliaries, others);
}

void write_fields_vdb(const std::filesystem::path& path, const VdbBox& box, std::size_t count,
                      const std::function<VdbField(std::size_t)>& field) {
  const FileLibraryLock lock;
  vdb_module().write_fields(path, box, count, field);
}

}  // namespace cloudbow
