#include "io/hdf5_handle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <new>

namespace cloudbow::hdf5 {

namespace {

constexpr hssize_t most_numbers = 1 << 16;  // in an attribute: as many as wavelengths of a spectrum, and room
constexpr std::size_t longest_text = 1 << 20;

Handle open_attribute(hid_t object, const char* name) {
  return {H5Aopen(object, name, H5P_DEFAULT), H5Aclose, "open an attribute"};
}

std::size_t number_count(hid_t attribute, const char* name) {
  const Handle space(H5Aget_space(attribute), H5Sclose, "read an attribute");
  const hssize_t count = check(H5Sget_simple_extent_npoints(space), "read an attribute");
  if (count > most_numbers) throw Error(fmt::format("attribute {} has {} values", name, count));
  return static_cast<std::size_t>(count);
}

void check_single(hid_t attribute, const char* name, const char* what) {
  const std::size_t count = number_count(attribute, name);
  if (count != 1) throw Error(fmt::format("attribute {} has {} values, allowed one {}", name, count, what));
}

bool has_chunk_without_bytes(hid_t dataset) {
  const Handle properties(H5Dget_create_plist(dataset), H5Pclose, "read a layout");
  if (H5Pget_layout(properties) != H5D_CHUNKED) return false;
  const Handle space(H5Dget_space(dataset), H5Sclose, "read a shape");
  hsize_t chunks = 0;
  check(H5Dget_num_chunks(dataset, space, &chunks), "count chunks");
  for (hsize_t n = 0; n < chunks; ++n) {
    std::array<hsize_t, H5S_MAX_RANK> offset{};
    unsigned filters = 0;
    haddr_t address = 0;
    hsize_t bytes = 0;
    check(H5Dget_chunk_info(dataset, space, n, offset.data(), &filters, &address, &bytes), "look at a chunk");
    if (bytes == 0) return true;
  }
  return false;
}

template <class Number>
Number one_number(hid_t object, const char* name, hid_t type) {
  const Handle attribute = open_attribute(object, name);
  check_single(attribute, name, "number");
  Number value = 0;
  check(H5Aread(attribute, type, &value), "read an attribute");
  return value;
}

Handle selected(hid_t dataset, const Block& block) {
  assert(block.start.size() == block.size.size());
  Handle space(H5Dget_space(dataset), H5Sclose, "read a shape");
  check(H5Sselect_hyperslab(space, H5S_SELECT_SET, block.start.data(), nullptr, block.size.data(), nullptr),
        "choose a part of a dataset");
  return space;
}

}  // namespace

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

void finish_file(Handle& file) {
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), "flush a file");
  file.close();
}

Handle open_dataset(hid_t location, const char* name) {
  return {H5Dopen2(location, name, H5P_DEFAULT), H5Dclose, "open a dataset"};
}

Handle open_group(hid_t location, const char* name) {
  return {H5Gopen2(location, name, H5P_DEFAULT), H5Gclose, "open a group"};
}

bool exists(hid_t location, const char* name) { return check(H5Lexists(location, name, H5P_DEFAULT), "look") > 0; }

bool has_attribute(hid_t object, const char* name) { return check(H5Aexists(object, name), "look") > 0; }

std::vector<std::string> member_names(hid_t group, H5_index_t order) {
  std::vector<std::string> names;
  const auto take = [](hid_t, const char* name, const H5L_info_t*, void* result) -> herr_t {
    static_cast<std::vector<std::string>*>(result)->emplace_back(name);
    return 0;
  };
  check(H5Literate(group, order, H5_ITER_INC, nullptr, take, &names), "list a file");
  return names;
}

Handle dataspace(const std::vector<hsize_t>& shape) {
  return {H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose, "create a dataspace"};
}

std::vector<hsize_t> shape_of(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), H5Sclose, "read a shape");
  std::vector<hsize_t> shape(static_cast<std::size_t>(check(H5Sget_simple_extent_ndims(space), "read a shape")));
  if (!shape.empty()) check(H5Sget_simple_extent_dims(space, shape.data(), nullptr), "read a shape");
  return shape;
}

std::size_t value_count(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), H5Sclose, "read a shape");
  return static_cast<std::size_t>(check(H5Sget_simple_extent_npoints(space), "read a shape"));
}

std::size_t value_bytes(hid_t dataset) {
  const Handle type(H5Dget_type(dataset), H5Tclose, "read a type");
  return H5Tget_size(type);
}

std::size_t Block::values() const {
  std::size_t count = 1;
  for (const hsize_t length : size) {
    if (length > std::numeric_limits<std::size_t>::max() / std::max<std::size_t>(count, 1))
      throw Error("a dataset is larger than any memory");
    count *= length;
  }
  return count;
}

void read_values(hid_t dataset, hid_t memory_type, hid_t memory_space, hid_t file_space, void* values) {
  try {
    check(H5Dread(dataset, memory_type, memory_space, file_space, H5P_DEFAULT, values), "read a dataset");
  } catch (const std::bad_alloc&) {
    // HDF5 allocates what a filtered chunk states as its size, and takes no bytes for no memory.
    if (has_chunk_without_bytes(dataset)) throw Error("a chunk has the size 0");
    throw;
  }
}

void read_block(hid_t dataset, const Block& block, hid_t memory_type, void* values) {
  const Handle space = selected(dataset, block), memory = dataspace(block.size);
  read_values(dataset, memory_type, memory, space, values);
}

void write_block(hid_t dataset, const Block& block, hid_t memory_type, const void* values) {
  const Handle space = selected(dataset, block), memory = dataspace(block.size);
  check(H5Dwrite(dataset, memory_type, memory, space, H5P_DEFAULT, values), "write a dataset");
}

std::vector<double> attribute_numbers(hid_t object, const char* name) {
  const Handle attribute = open_attribute(object, name);
  std::vector<double> value(number_count(attribute, name));
  if (!value.empty()) check(H5Aread(attribute, H5T_NATIVE_DOUBLE, value.data()), "read an attribute");
  return value;
}

double attribute_number(hid_t object, const char* name) { return one_number<double>(object, name, H5T_NATIVE_DOUBLE); }

std::int64_t attribute_integer(hid_t object, const char* name) {
  return one_number<std::int64_t>(object, name, H5T_NATIVE_INT64);
}

std::string attribute_text(hid_t object, const char* name) {
  const Handle attribute = open_attribute(object, name);
  check_single(attribute, name, "text");
  const Handle type(H5Aget_type(attribute), H5Tclose, "read a type");
  const std::size_t bytes = H5Tget_size(type);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 || bytes > longest_text)
    throw Error(fmt::format("attribute {} is not a text of fixed length", name));
  std::string text(bytes, '\0');
  check(H5Aread(attribute, type, text.data()), "read an attribute");
  text.resize(std::min(text.size(), text.find('\0')));
  return text;
}

}  // namespace cloudbow::hdf5
