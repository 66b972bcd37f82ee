// What the readers and writers of HDF5 share: opening, shapes, and attributes that are exactly what belongs there.
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <string>
#include <vector>

#include "cloudbow/core/hdf5_file.hpp"

namespace cloudbow::hdf5 {

Handle create_file(const std::filesystem::path& path);
Handle open_dataset(hid_t location, const char* name);
Handle property_list(hid_t type);

bool exists(hid_t location, const char* name);
bool has_attribute(hid_t object, const char* name);

/// Lengths of a dataset's dimensions; empty: one value.
std::vector<hsize_t> shape_of(hid_t dataset);

/// The numbers of an attribute, one or several.
std::vector<double> attribute_numbers(hid_t object, const char* name);
/// @throws Error unless the attribute holds exactly one.
double attribute_number(hid_t object, const char* name);
std::int64_t attribute_integer(hid_t object, const char* name);
/// @throws Error unless the attribute is one text of fixed length.
std::string attribute_text(hid_t object, const char* name);

}  // namespace cloudbow::hdf5
