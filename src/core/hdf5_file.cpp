#include "cloudbow/core/hdf5_file.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <array>
#include <cerrno>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/input_file.hpp"
#include "cloudbow/core/printable.hpp"

namespace cloudbow::hdf5 {

static_assert(std::is_same_v<hid_t, std::int64_t> && std::is_same_v<herr_t, int>);

namespace {

/// HDF5's error stack, innermost failure first.
struct Failure {
  std::string text;  ///< of the innermost, or the system's own message, which stands in it as: error message = '...'
  bool of_lock = false;  ///< another program holds the file
  bool of_memory = false;
};

herr_t collect(unsigned position, const H5E_error2_t* entry, void* result) {
  auto& failure = *static_cast<Failure*>(result);
  const std::string description = entry->desc != nullptr ? entry->desc : "";
  if (position == 0) {
    failure.text = description;
    failure.of_memory = description.find("memory allocation failed") != std::string::npos;
  }
  if (description.find("unable to lock file") != std::string::npos &&
      description.find(fmt::format("errno = {},", EWOULDBLOCK)) != std::string::npos) {
    failure.of_lock = true;
  }
  static constexpr std::string_view mark = "error message = '";
  const auto begin = description.find(mark);
  if (begin == std::string::npos) return 0;
  const auto end = description.find('\'', begin + mark.size());
  failure.text = description.substr(begin + mark.size(), end - begin - mark.size());
  return 1;
}

Failure take_failure() {
  Failure failure;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, collect, &failure);
  H5Eclear2(H5E_DEFAULT);
  return failure;
}

[[noreturn]] void throw_failure(const Failure& failure, const char* what) {
  if (failure.of_memory) throw std::bad_alloc();
  throw Error(failure.text.empty() ? fmt::format("HDF5 failed: {}", what) : failure.text);
}

/// Filters that HDF5 itself has; any other is a plug-in that it would load.
std::string foreign_filter(hid_t properties) {
  const int count = check(H5Pget_nfilters(properties), "read filters");
  for (int n = 0; n < count; ++n) {
    unsigned flags = 0;
    std::size_t values = 0;
    std::array<char, 64> name{};
    const H5Z_filter_t filter = check(H5Pget_filter2(properties, static_cast<unsigned>(n), &flags, &values, nullptr,
                                                     name.size() - 1, name.data(), nullptr),
                                      "read a filter");
    if (filter > H5Z_FILTER_SCALEOFFSET) return fmt::format("filter {} of a plug-in ({})", filter, name.data());
  }
  return {};
}

/// Storage outside its file to which an object refers; empty if there is none.
std::string leads_elsewhere(hid_t group, const char* name) {
  const Handle object(H5Oopen(group, name, H5P_DEFAULT), H5Oclose, "open an object");
  if (H5Iget_type(object) != H5I_DATASET) return {};
  const Handle properties(H5Dget_create_plist(object), H5Pclose, "read a layout");
  if (check(H5Pget_layout(properties), "read a layout") == H5D_VIRTUAL) return "a virtual dataset";
  if (check(H5Pget_external_count(properties), "read a layout") > 0) return "a dataset stored in other files";
  return foreign_filter(properties);
}

struct Walk {
  std::string found;  ///< the first that leads elsewhere
  std::string failure;
};

/// For H5Lvisit, which itself follows hard links alone. No exception may pass through HDF5.
herr_t look_at(hid_t group, const char* name, const H5L_info_t* link, void* result) {
  auto& walk = *static_cast<Walk*>(result);
  try {
    if (link->type == H5L_TYPE_EXTERNAL) {
      walk.found = fmt::format("'{}', a link to another file", name);
    } else if (link->type >= H5L_TYPE_UD_MIN) {
      walk.found = fmt::format("'{}', a link of a plug-in", name);
    } else if (link->type == H5L_TYPE_HARD) {
      if (const std::string kind = leads_elsewhere(group, name); !kind.empty())
        walk.found = fmt::format("'{}', {}", name, kind);
    }
    return walk.found.empty() ? 0 : 1;
  } catch (const std::exception& error) {
    walk.failure = error.what();
    return -1;
  }
}

void check_links(hid_t file, const std::filesystem::path& path) {
  Walk walk;
  const herr_t status = H5Lvisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, look_at, &walk);
  if (!walk.failure.empty()) throw Error(walk.failure);
  check(status, "list a file");
  if (walk.found.empty()) return;
  throw InputError(fmt::format(
      "{}: leads elsewhere (found {}, allowed a file that holds its data itself, with the filters of HDF5); "
      "write a copy "
      "with h5repack, or by the program that made it",
      path.string(), printable(walk.found)));
}

}  // namespace

void throw_error(const char* what) { throw_failure(take_failure(), what); }

void start_library() {
  static std::once_flag started;
  std::call_once(started, [] { H5dont_atexit(); });
  // Each thread has its own error stack, which is printed unless the thread says otherwise.
  thread_local const bool is_quiet = H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr) >= 0;
  static_cast<void>(is_quiet);
}

Handle open_file(const std::filesystem::path& path) {
  start_library();
  check_input(path, "an HDF5 file");
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (id < 0) {
    const Failure failure = take_failure();
    if (!failure.of_lock) throw_failure(failure, "open a file");
    throw InputError(fmt::format(
        "{}: is locked (found a program that is writing it, allowed a file that none writes); wait until it "
        "has ended, or read a copy",
        path.string()));
  }
  Handle file(id, H5Fclose, "open a file");
  check_links(file, path);
  return file;
}

void check_file(const std::filesystem::path& path) {
  start_library();
  check_input(path, "a regular file");
  const htri_t is_hdf5 = H5Fis_hdf5(path.c_str());
  if (is_hdf5 < 0) H5Eclear2(H5E_DEFAULT);
  if (is_hdf5 == 0) return;
  try {
    open_file(path);
  } catch (const Error& error) {
    throw InputError(fmt::format("{}: damaged, or no HDF5 file ({})", path.string(), error.what()));
  }
}

}  // namespace cloudbow::hdf5
