#include "cloudbow/medium/vdb_file.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <pthread.h>

#include <chrono>
#include <cstdint>
#include <thread>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/file_library_lock.hpp"
#include "cloudbow/core/sandbox.hpp"
#include "cloudbow/medium/cloud_amounts.hpp"
#include "cloudbow/medium/plausibility.hpp"
#include "vdb_module.hpp"

namespace cloudbow {

namespace {

constexpr const char* module_file = "cloudbow_vdb.so";

#if defined(__SANITIZE_ADDRESS__)  // GCC
constexpr bool has_address_sanitizer = true;
#elif defined(__has_feature)  // Clang
constexpr bool has_address_sanitizer = __has_feature(address_sanitizer);
#else
constexpr bool has_address_sanitizer = false;
#endif

#if defined(__SANITIZE_THREAD__)
constexpr bool has_thread_sanitizer = true;
#elif defined(__has_feature)
constexpr bool has_thread_sanitizer = __has_feature(thread_sanitizer);
#else
constexpr bool has_thread_sanitizer = false;
#endif

#if defined(RTLD_DEEPBIND)
constexpr int own_symbols_first = RTLD_DEEPBIND;
#else
constexpr int own_symbols_first = 0;  // not in other C libraries
#endif

/// OpenVDB's log starts threads as it is loaded. It ends the program, or never returns, if there is no memory for them.
void check_memory_to_load() {
  constexpr std::uint64_t log_threads = 4;
  constexpr std::uint64_t libraries = 100'000'000;  // 65 MB, and what reading a small file takes
  pthread_attr_t attributes{};
  std::size_t stack = 8'388'608;
  if (pthread_getattr_default_np(&attributes) == 0) {
    pthread_attr_getstacksize(&attributes, &stack);
    pthread_attr_destroy(&attributes);
  }
  const std::uint64_t left = memory_left_by_limits(), needed = libraries + log_threads * stack;
  if (left >= needed) return;
  throw InputError(fmt::format(
      "{}: too little memory to load OpenVDB (found {} MB that the limits of this process leave, allowed {} "
      "MB and more) raise `ulimit -v` and `ulimit -d`",
      module_file, left / 1'000'000, needed / 1'000'000));
}

const void* load_symbol() {
  // OpenVDB has 60,000 symbols to find. In its own libraries first, that takes 30 ms; in those of the program
  // first, 55. The runtimes of sanitizers refuse this order.
  constexpr bool sanitized = has_address_sanitizer || has_thread_sanitizer;
  void* const library = dlopen(module_file, RTLD_NOW | RTLD_LOCAL | (sanitized ? 0 : own_symbols_first));
  const void* const symbol = library != nullptr ? dlsym(library, "cloudbow_vdb_module") : nullptr;
  if (symbol == nullptr) {
    throw InputError(
        fmt::format("{}: the part of cloudbow that reads and writes OpenVDB files cannot be loaded ({}) "
                    "install cloudbow anew, or add the module's folder to LD_LIBRARY_PATH",
                    module_file, dlerror()));
  }
  return symbol;
}

/// Found by the run path of the program: its build folder, or lib/cloudbow beside the bin/ that it is installed in.
/// It stays loaded: OpenVDB's threads outlive any call.
const VdbModule& vdb_module() {
  static const VdbModule& module = []() -> const VdbModule& {
    check_memory_to_load();
    const void* const symbol = load_symbol();
    // The address sanitizer's allocator, unlike the C library's, is not kept consistent over a fork. So the threads
    // that OpenVDB's log has just started must be idle before the first read in a sandbox.
    if constexpr (has_address_sanitizer) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return *static_cast<const VdbModule*>(symbol);
  }();
  return module;
}

}  // namespace

VdbCloud read_cloud_vdb(const std::filesystem::path& path, const VdbReadOptions& options) {
  const FileLibraryLock lock;
  return vdb_module().read_cloud(path, options);
}

std::vector<float> read_auxiliary_vdb(const std::filesystem::path& path, const CloudField& cloud,
                                      const VdbReadOptions& options, double lowest, double highest) {
  const FileLibraryLock lock;
  return vdb_module().read_auxiliary(path, cloud, options, lowest, highest);
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
