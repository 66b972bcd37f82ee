#include "cloudbow/results/checkpoint_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <utility>
#include <vector>

#include "atomic_file.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/rehearsal.hpp"
#include "hdf5_handle.hpp"
#include "netcdf4_file.hpp"

namespace cloudbow {

using hdf5::check;
using hdf5::Handle;

namespace {

constexpr std::int32_t kFormat = 1;
constexpr hsize_t kChunkValues = hsize_t{1} << 17;

hid_t type_of(const StateArray& array) {
  assert(array.value_bytes == 2 || array.value_bytes == 4 || array.value_bytes == 8);
  return array.value_bytes == 2 ? H5T_NATIVE_UINT16 : array.value_bytes == 4 ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE;
}

std::vector<hsize_t> shape_of(const StateArray& array) { return {array.rows.size(), array.length}; }

Handle space_of(const std::vector<hsize_t>& shape) {
  return {H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose, "make a shape"};
}

/// Calls transfer(memory space, file space, row) for each row.
template <class Transfer>
void for_each_row(hid_t dataset, const StateArray& array, const Transfer& transfer) {
  const Handle memory = space_of({array.length});
  const Handle file(H5Dget_space(dataset), H5Sclose, "read a shape");
  for (hsize_t r = 0; r < array.rows.size(); ++r) {
    const hsize_t begin[2] = {r, 0};
    const hsize_t count[2] = {1, array.length};
    check(H5Sselect_hyperslab(file, H5S_SELECT_SET, begin, nullptr, count, nullptr), "choose a row");
    transfer(memory, file, array.rows[r]);
  }
}

void write_array(hid_t file, const StateArray& array) {
  const std::vector<hsize_t> shape = shape_of(array);
  const Handle space = space_of(shape);
  const Handle creation = hdf5::property_list(H5P_DATASET_CREATE);
  check(H5Pset_obj_track_times(creation, false), "leave out times");
  const hsize_t chunk[2] = {1, std::clamp<hsize_t>(array.length, 1, kChunkValues)};
  check(H5Pset_chunk(creation, 2, chunk), "choose chunks");
  check(H5Pset_fletcher32(creation), "choose checksums");
  Handle dataset(H5Dcreate2(file, array.name.c_str(), type_of(array), space, H5P_DEFAULT, creation, H5P_DEFAULT),
                 H5Dclose, "create a dataset");
  for_each_row(dataset, array, [&](hid_t memory, hid_t row, const void* values) {
    check(H5Dwrite(dataset, type_of(array), memory, row, H5P_DEFAULT, values), "write a dataset");
  });
  dataset.close();
}

template <class Read>
auto attribute(hid_t file, const char* name, const Read& read) {
  const Handle handle(H5Aopen(file, name, H5P_DEFAULT), H5Aclose, "open an attribute");
  return read(handle);
}

std::uint64_t number_attribute(hid_t file, const char* name) {
  return attribute(file, name, [](hid_t handle) {
    std::int64_t number = 0;
    check(H5Aread(handle, H5T_NATIVE_INT64, &number), "read an attribute");
    return static_cast<std::uint64_t>(number);
  });
}

std::string text_attribute(hid_t file, const char* name) {
  return attribute(file, name, [](hid_t handle) {
    const Handle type(H5Aget_type(handle), H5Tclose, "read a type");
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0) throw hdf5::Error("no text");
    std::string text(H5Tget_size(type), '\0');
    check(H5Aread(handle, type, text.data()), "read an attribute");
    text.resize(std::min(text.size(), text.find('\0')));
    return text;
  });
}

/// Calls of HDF5 that say what is wrong, with the file's name.
template <class Use>
auto naming(const std::filesystem::path& path, const Use& use) {
  try {
    return use();
  } catch (const hdf5::Error& error) {
    throw InputError(fmt::format("{}: can't be read as a checkpoint ({}); allowed: a file of run --checkpoint",
                                 path.string(), error.what()));
  }
}

}  // namespace

void write_checkpoint(const std::filesystem::path& path, const std::string& source, const StateKey& key,
                      std::span<const StateArray> state) {
  AtomicFile target(path);
  try {
    Handle file = hdf5::create_file(target.temporary());
    netcdf4::write_attributes(file, {{"source", source},
                                     {"checkpoint_format", kFormat},
                                     {"layout", static_cast<std::int64_t>(key.layout)},
                                     {"problem", static_cast<std::int64_t>(key.problem)}});
    for (const StateArray& array : state) write_array(file, array);
    check(H5Fflush(file, H5F_SCOPE_GLOBAL), "flush a file");
    file.close();
  } catch (const hdf5::Error& error) {
    throw_unwritable(path, error.what());
  }
  target.commit();
}

struct CheckpointInput::Opened {
  Handle file;
};

CheckpointInput::CheckpointInput(const std::filesystem::path& path) : path_(path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw InputError(fmt::format("{}: there is no such file (allowed: a file of run --checkpoint)", path.string()));
  }
  // Its values are read later, under their checksums.
  after_rehearsal(path, {.library = "HDF5"}, [&] {
    naming(path, [&] {
      opened_ = std::make_unique<Opened>(Opened{hdf5::open_file(path)});
      const std::uint64_t format = number_attribute(opened_->file, "checkpoint_format");
      if (format != kFormat) throw hdf5::Error(fmt::format("format {}, known is {}", format, kFormat));
      key_ = {number_attribute(opened_->file, "layout"), number_attribute(opened_->file, "problem")};
      source_ = text_attribute(opened_->file, "source");
    });
    return true;
  });
}

CheckpointInput::~CheckpointInput() = default;

void CheckpointInput::load(const StateArray& array) const {
  naming(path_, [&] {
    const Handle dataset = hdf5::open_dataset(opened_->file, array.name.c_str());
    const Handle space(H5Dget_space(dataset), H5Sclose, "read a shape");
    std::vector<hsize_t> shape(2, 0);
    if (H5Sget_simple_extent_ndims(space) != 2) throw hdf5::Error(fmt::format("{} has another shape", array.name));
    check(H5Sget_simple_extent_dims(space, shape.data(), nullptr), "read a shape");
    const Handle type(H5Dget_type(dataset), H5Tclose, "read a type");
    if (shape != shape_of(array) || H5Tget_size(type) != array.value_bytes)
      throw hdf5::Error(fmt::format("{} has another shape", array.name));
    for_each_row(dataset, array, [&](hid_t memory, hid_t row, void* values) {
      check(H5Dread(dataset, type_of(array), memory, row, H5P_DEFAULT, values), "read a dataset");
    });
  });
}

}  // namespace cloudbow
