#include "cloudbow/io/checkpoint_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/file_library_lock.hpp"
#include "cloudbow/core/input_file.hpp"
#include "cloudbow/core/printable.hpp"
#include "cloudbow/core/sandbox.hpp"
#include "io/hdf5_handle.hpp"
#include "io/netcdf4_file.hpp"

namespace cloudbow {

using hdf5::check;
using hdf5::Handle;

namespace {

constexpr std::int32_t checkpoint_format = 5;
constexpr hsize_t chunk_values = hsize_t{1} << 17;

constexpr const char* allowed = "a file of run --checkpoint";

bool is_known_size(std::size_t value_bytes) { return value_bytes == 2 || value_bytes == 4 || value_bytes == 8; }

hid_t type_of(std::size_t value_bytes) {
  assert(is_known_size(value_bytes));
  return value_bytes == 2 ? H5T_NATIVE_UINT16 : value_bytes == 4 ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE;
}

std::vector<hsize_t> shape_of(const StateArray& array) { return {array.rows.size(), array.length}; }

hdf5::Block row_of(const std::vector<hsize_t>& shape, hsize_t r) { return {{r, 0}, {1, shape[1]}}; }

void write_array(hid_t file, const StateArray& array) {
  const std::vector<hsize_t> shape = shape_of(array);
  const Handle space = hdf5::dataspace(shape);
  const Handle creation = hdf5::property_list(H5P_DATASET_CREATE);
  check(H5Pset_obj_track_times(creation, false), "leave out times");
  const hsize_t chunk[2] = {1, std::clamp<hsize_t>(array.length, 1, chunk_values)};
  check(H5Pset_chunk(creation, 2, chunk), "choose chunks");
  check(H5Pset_fletcher32(creation), "choose checksums");
  const hid_t type = type_of(array.value_bytes);
  Handle dataset(H5Dcreate2(file, array.name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose,
                 "create a dataset");
  for (hsize_t r = 0; r < shape[0]; ++r) hdf5::write_block(dataset, row_of(shape, r), type, array.rows[r]);
  dataset.close();
}

std::uint64_t key_attribute(hid_t file, const char* name) {
  return static_cast<std::uint64_t>(hdf5::attribute_integer(file, name));
}

template <class Number>
bool all_finite(const void* values, std::size_t count) {
  const std::span numbers(static_cast<const Number*>(values), count);
  return std::all_of(numbers.begin(), numbers.end(), [](Number number) {
    constexpr std::uint16_t exponent_of_half = 0x7c00;  // all ones: infinity or not a number
    if constexpr (std::is_integral_v<Number>) return (number & exponent_of_half) != exponent_of_half;
    return std::isfinite(static_cast<double>(number));
  });
}

bool all_finite(const void* values, std::size_t count, std::size_t value_bytes) {
  return value_bytes == 2   ? all_finite<std::uint16_t>(values, count)
         : value_bytes == 4 ? all_finite<float>(values, count)
                            : all_finite<double>(values, count);
}

/// Row by row as load() does, for the child process in which a damaged file may crash HDF5.
void read_every_value(hid_t file, std::uintmax_t file_bytes) {
  for (const std::string& name : hdf5::member_names(file, H5_INDEX_NAME)) {
    const Handle dataset = hdf5::open_dataset(file, name.c_str());
    const std::vector<hsize_t> shape = hdf5::shape_of(dataset);
    const std::size_t value_bytes = hdf5::value_bytes(dataset);
    if (shape.size() != 2 || !is_known_size(value_bytes)) throw hdf5::Error(fmt::format("{} has another shape", name));
    const std::uintmax_t most = file_bytes / value_bytes;  // nothing is compressed
    if (shape[1] > most || shape[0] > most / std::max<hsize_t>(shape[1], 1))
      throw hdf5::Error(fmt::format("{} is larger than its file", name));
    std::vector<std::uint8_t> row(shape[1] * value_bytes);
    for (hsize_t r = 0; r < shape[0]; ++r)
      hdf5::read_block(dataset, row_of(shape, r), type_of(value_bytes), row.data());
  }
}

/// Calls of HDF5 whose errors name the problem and the file.
template <class Use>
auto naming(const std::filesystem::path& path, const Use& use) {
  try {
    return use();
  } catch (const hdf5::Error& error) {
    throw InputError(
        fmt::format("{}: can't be read as a checkpoint ({}); allowed: {}", path.string(), error.what(), allowed));
  }
}

[[noreturn]] void fail_version(const std::filesystem::path& path, std::int64_t format, const std::string& source) {
  throw InputError(
      fmt::format("{}: is a checkpoint of another version (found format {} by {}, allowed format {}); use that "
                  "program, or start anew",
                  path.string(), format, printable(source), checkpoint_format));
}

}  // namespace

void write_checkpoint(const std::filesystem::path& path, const std::string& source, const StateKey& key,
                      std::span<const StateArray> state) {
  const FileLibraryLock lock;
  AtomicFile target(path);
  try {
    Handle file = hdf5::create_file(target.temporary());
    netcdf4::write_attributes(file, {{"source", source},
                                     {"checkpoint_format", checkpoint_format},
                                     {"layout", static_cast<std::int64_t>(key.layout)},
                                     {"problem", static_cast<std::int64_t>(key.problem)}});
    for (const StateArray& array : state) write_array(file, array);
    hdf5::finish_file(file);
  } catch (const hdf5::Error& error) {
    throw_unwritable(path, error.what());
  }
  target.commit();
}

struct CheckpointInput::Opened {
  Handle file;
};

CheckpointInput::CheckpointInput(const std::filesystem::path& path) : path_(path) {
  check_input(path, allowed);
  const FileLibraryLock lock;
  const auto open = [&] {
    opened_ = std::make_unique<Opened>(Opened{hdf5::open_file(path)});
    const std::int64_t format = hdf5::attribute_integer(opened_->file, "checkpoint_format");
    source_ = hdf5::attribute_text(opened_->file, "source");
    if (format != checkpoint_format) fail_version(path, format, source_);
    key_ = {key_attribute(opened_->file, "layout"), key_attribute(opened_->file, "problem")};
  };
  read_in_sandbox(path, {.library = "HDF5"}, [&] {
    naming(path, [&] {
      open();
      read_every_value(opened_->file, std::filesystem::file_size(path));
    });
  });
  naming(path, open);
}

CheckpointInput::~CheckpointInput() = default;

void CheckpointInput::load(const StateArray& array) const {
  const FileLibraryLock lock;
  naming(path_, [&] {
    const Handle dataset = hdf5::open_dataset(opened_->file, array.name.c_str());
    const std::vector<hsize_t> shape = hdf5::shape_of(dataset);
    if (shape != shape_of(array) || hdf5::value_bytes(dataset) != array.value_bytes)
      throw hdf5::Error(fmt::format("{} has another shape", array.name));
    for (hsize_t r = 0; r < shape[0]; ++r) {
      hdf5::read_block(dataset, row_of(shape, r), type_of(array.value_bytes), array.rows[r]);
      if (!all_finite(array.rows[r], array.length, array.value_bytes))
        throw hdf5::Error(fmt::format("{}: row {} holds numbers that are not finite", array.name, r));
    }
  });
}

}  // namespace cloudbow
