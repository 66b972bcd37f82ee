// HDF5 written as netCDF-4 requires: dimension scales on every axis, order of creation tracked, fill values,
// attributes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "io/hdf5_handle.hpp"

namespace cloudbow::netcdf4 {

using AttributeValue = std::variant<std::string, double, float, std::int32_t, std::int64_t, std::vector<double>,
                                    std::vector<std::int32_t>, std::vector<std::int64_t>>;

struct Attribute {
  std::string name;
  AttributeValue value;
};

hdf5::Handle create_group(hid_t parent, const char* name);
void write_attribute(hid_t object, const Attribute& attribute);
void write_attributes(hid_t object, const std::vector<Attribute>& attributes);

/// A dimension with its coordinate variable, float64.
void write_coordinate(hid_t group, const char* name, std::span<const double> values,
                      const std::vector<Attribute>& attributes);
/// A dimension that only has a length.
void write_dimension(hid_t group, const char* name, std::size_t size);

/// A variable on dimensions of the same group. Floats get _FillValue = NaN; large ones are chunked, shuffled and
/// deflated.
void write_variable(hid_t group, const char* name, const std::vector<std::string>& dimensions,
                    std::span<const float> values, const std::vector<Attribute>& attributes);
void write_variable(hid_t group, const char* name, const std::vector<std::string>& dimensions,
                    std::span<const double> values, const std::vector<Attribute>& attributes);
void write_variable(hid_t group, const char* name, const std::vector<std::string>& dimensions,
                    std::span<const std::int32_t> values, const std::vector<Attribute>& attributes);

}  // namespace cloudbow::netcdf4
