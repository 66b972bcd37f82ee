#include "io/open_result.hpp"

#include <fmt/format.h>
#include <hdf5_hl.h>

#include <string>

#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

constexpr const char* runs_group = "runs";  // of write_sweep()

/// Swept dimensions, as arguments that choose one run: "zenith_deg=0, albedo=0".
std::string first_run(hid_t runs) {
  std::string text;
  for (const std::string& name : hdf5::member_names(runs, H5_INDEX_NAME)) {
    if (hdf5::check(H5DSis_scale(hdf5::open_dataset(runs, name.c_str())), "look at a variable") > 0)
      text += fmt::format("{}{}=0", text.empty() ? "" : ", ", name);
  }
  return text;
}

[[noreturn]] void throw_sweep(hid_t file, const std::string& where) {
  const hdf5::Handle runs = hdf5::open_group(file, runs_group);
  const std::size_t count =
      hdf5::exists(runs, "exit_code") ? hdf5::value_count(hdf5::open_dataset(runs, "exit_code")) : 0;
  throw InputError(
      fmt::format("{}: it holds a sweep (found {} runs, allowed the result of one run); in Python one run is "
                  "cloudbow.open_result(\"{}\").isel({})",
                  where, count, where, first_run(runs)));
}

}  // namespace

hdf5::Handle open_result(const std::filesystem::path& path) {
  hdf5::Handle file = hdf5::open_file(path);
  if (hdf5::exists(file, runs_group)) throw_sweep(file, path.string());
  return file;
}

}  // namespace cloudbow
