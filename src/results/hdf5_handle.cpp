#include "hdf5_handle.hpp"

#include <fmt/format.h>

#include <mutex>

#include "cloudbow/core/file_lock.hpp"

namespace cloudbow::hdf5 {

namespace {

/// The stack runs from the innermost failure outwards. The system's own message stands in a description as: error
/// message = '...'.
herr_t collect(unsigned position, const H5E_error2_t* entry, void* result) {
  auto& text = *static_cast<std::string*>(result);
  const std::string description = entry->desc != nullptr ? entry->desc : "";
  if (position == 0) text = description;
  static constexpr std::string_view mark = "error message = '";
  const auto begin = description.find(mark);
  if (begin != std::string::npos) {
    const auto end = description.find('\'', begin + mark.size());
    text = description.substr(begin + mark.size(), end - begin - mark.size());
    return 1;
  }
  return 0;
}

}  // namespace

void throw_error(const char* what) {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, collect, &text);
  H5Eclear2(H5E_DEFAULT);
  throw Error(text.empty() ? fmt::format("HDF5 failed: {}", what) : text);
}

void start_library() {
  static std::once_flag started;
  std::call_once(started, [] {
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  });
}

Handle property_list(hid_t type) { return {H5Pcreate(type), H5Pclose, "create a property list"}; }

Handle create_file(const std::filesystem::path& path) {
  start_library();
  // netCDF-4 needs the order of creation of links and attributes. Times would make equal results differ.
  const Handle creation = property_list(H5P_FILE_CREATE);
  check(H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED), "track links");
  check(H5Pset_attr_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED), "track attributes");
  check(H5Pset_obj_track_times(creation, false), "leave out times");
  const Handle access = property_list(H5P_FILE_ACCESS);
  check(H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18), "choose the format's version");
  check(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), "close strictly");
  return {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access), H5Fclose, "create a file"};
}

Handle open_file(const std::filesystem::path& path) {
  start_library();
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0 && is_locked(path)) throw Error(kLockedFile);
  return {file, H5Fclose, "open a file"};
}

Handle open_dataset(hid_t location, const char* name) {
  return {H5Dopen2(location, name, H5P_DEFAULT), H5Dclose, "open a dataset"};
}

}  // namespace cloudbow::hdf5
