#include "cloudbow/medium/vdb_file.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/rehearsal.hpp"
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

const void* load_symbol() {
  void* const library = dlopen(module_file, RTLD_NOW | RTLD_LOCAL);
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
    // OpenVDB's log starts threads as it is loaded, and aborts the program if they find no memory.
    if (memory_is_limited()) rehearse(module_file, {.library = "OpenVDB's log"}, [] { load_symbol(); });
    const void* const symbol = load_symbol();
    // The address sanitizer's allocator, unlike the C library's, is not kept whole over a fork: the threads that
    // OpenVDB's log has just started are to be at rest before the first rehearsal.
    if constexpr (has_address_sanitizer) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return *static_cast<const VdbModule*>(symbol);
  }();
  return module;
}

}  // namespace

CloudField read_cloud_vdb(const std::filesystem::path& path, const VdbReadOptions& options) {
  return vdb_module().read_cloud(path, options);
}

std::vector<float> read_companion_vdb(const std::filesystem::path& path, const CloudField& cloud,
                                      const VdbReadOptions& options, double lowest, double highest) {
  return vdb_module().read_companion(path, cloud, options, lowest, highest);
}

CloudInfo describe_cloud_vdb(const std::filesystem::path& path) {
  CloudInfo info{.path = path, .bytes = 0, .grids = vdb_module().list_grids(path)};
  info.bytes = std::filesystem::file_size(path);
  for (auto& grid : info.grids) {
    try {
      VdbReadOptions options;
      options.grid = grid.name;
      grid.cloud = summarize(read_cloud_vdb(path, options));
    } catch (const InputError& error) {
      grid.reason = error.what();
    }
  }
  return info;
}

void write_cloud_vdb(const std::filesystem::path& path, const CloudField& field, const VdbWriteOptions& options,
                     const std::vector<VdbCompanion>& companions) {
  vdb_module().write_cloud(path, field, options, companions);
}

void write_fields_vdb(const std::filesystem::path& path, const VdbBox& box, std::size_t count,
                      const std::function<VdbField(std::size_t)>& field) {
  vdb_module().write_fields(path, box, count, field);
}

}  // namespace cloudbow
