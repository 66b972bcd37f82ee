// Functions that all readers and writers of HDF5 share: opening, shapes, values of datasets, and attributes of exactly
// the expected kind. Opening an input and return codes are in core/hdf5_file.hpp.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <type_traits>
#include <vector>

#include "cloudbow/core/hdf5_file.hpp"

namespace cloudbow::hdf5 {

Handle create_file(const std::filesystem::path& path);
/// Flushes, then closes: after a failed write closing alone may report success and leave zeros in the file.
/// @throws Error if the disk does not take it.
void finish_file(Handle& file);
Handle open_dataset(hid_t location, const char* name);
Handle open_group(hid_t location, const char* name);
Handle property_list(hid_t type);

bool exists(hid_t location, const char* name);
bool has_attribute(hid_t object, const char* name);

/// Names of a group's members. @param order by name (H5_INDEX_NAME) or by age (H5_INDEX_CRT_ORDER)
std::vector<std::string> member_names(hid_t group, H5_index_t order);

Handle dataspace(const std::vector<hsize_t>& shape);

/// Lengths of a dataset's dimensions; empty: one value.
std::vector<hsize_t> shape_of(hid_t dataset);
/// Values of a dataset, of all dimensions together.
std::size_t value_count(hid_t dataset);
/// Bytes of a stored value.
std::size_t value_bytes(hid_t dataset);

/// The HDF5 type of a number in memory.
template <class Number>
hid_t memory_type() {
  if constexpr (std::is_same_v<Number, float>) return H5T_NATIVE_FLOAT;
  if constexpr (std::is_same_v<Number, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<Number, std::int32_t>) return H5T_NATIVE_INT32;
  if constexpr (std::is_same_v<Number, std::int64_t>) return H5T_NATIVE_INT64;
}

/// Part of a dataset: along each of its dimensions `size` values from `start` on.
struct Block {
  std::vector<hsize_t> start, size;

  /// Number of elements. @throws Error if there are more than memory can have.
  std::size_t values() const;
};

/// H5Dread. @throws Error, also if the file is damaged in a way that HDF5 takes for a lack of memory; std::bad_alloc.
void read_values(hid_t dataset, hid_t memory_type, hid_t memory_space, hid_t file_space, void* values);

/// Reads or writes a block, whose values lie one after the other in memory.
void read_block(hid_t dataset, const Block& block, hid_t memory_type, void* values);
void write_block(hid_t dataset, const Block& block, hid_t memory_type, const void* values);

template <class Number>
std::vector<Number> read_block(hid_t dataset, const Block& block) {
  std::vector<Number> values(block.values());
  read_block(dataset, block, memory_type<Number>(), values.data());
  return values;
}

/// All values of a dataset, in the order of the file; none if it is empty.
template <class Number>
std::vector<Number> read_all(hid_t dataset) {
  std::vector<Number> values(value_count(dataset));
  if (!values.empty()) read_values(dataset, memory_type<Number>(), H5S_ALL, H5S_ALL, values.data());
  return values;
}

/// The numbers of an attribute, one or several.
std::vector<double> attribute_numbers(hid_t object, const char* name);
/// @throws Error unless the attribute holds exactly one.
double attribute_number(hid_t object, const char* name);
std::int64_t attribute_integer(hid_t object, const char* name);
/// @throws Error unless the attribute is one text of fixed length.
std::string attribute_text(hid_t object, const char* name);

}  // namespace cloudbow::hdf5
