#include "io/stored_result.hpp"

#include <fmt/format.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "cloudbow/core/digest.hpp"

namespace cloudbow {
namespace {

using hdf5::check;
using hdf5::Handle;
using netcdf4::Attribute;
using netcdf4::AttributeValue;
using netcdf4::BlockVariable;

constexpr std::array<std::string_view, 5> of_scales{"CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST", "_FillValue"};

std::vector<std::string> attribute_names(hid_t object) {
  std::vector<std::string> names;
  const auto take = [](hid_t, const char* name, const H5A_info_t*, void* result) -> herr_t {
    static_cast<std::vector<std::string>*>(result)->emplace_back(name);
    return 0;
  };
  check(H5Aiterate2(object, H5_INDEX_CRT_ORDER, H5_ITER_INC, nullptr, take, &names), "list attributes");
  return names;
}

/// One number, or a vector of several.
template <class Number>
AttributeValue numbers(hid_t attribute, hid_t space) {
  std::vector<Number> values(static_cast<std::size_t>(check(H5Sget_simple_extent_npoints(space), "read an attribute")));
  if (!values.empty()) check(H5Aread(attribute, hdf5::memory_type<Number>(), values.data()), "read an attribute");
  if (H5Sget_simple_extent_type(space) == H5S_SCALAR) return values.front();
  return values;
}

AttributeValue value_of(hid_t object, const std::string& name) {
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, "open an attribute");
  const Handle type(H5Aget_type(attribute), H5Tclose, "read a type");
  const Handle space(H5Aget_space(attribute), H5Sclose, "read a shape");
  const std::size_t bytes = H5Tget_size(type);
  switch (H5Tget_class(type)) {
    case H5T_STRING:
      return hdf5::attribute_text(object, name.c_str());
    case H5T_FLOAT:
      return numbers<double>(attribute, space);
    case H5T_INTEGER:
      if (bytes == sizeof(std::int32_t)) return numbers<std::int32_t>(attribute, space);
      if (bytes == sizeof(std::int64_t)) return numbers<std::int64_t>(attribute, space);
      break;
    default:
      break;
  }
  throw hdf5::Error(fmt::format("attribute {} is neither a text nor numbers", name));
}

/// Variables of a mesh.
constexpr std::array<std::string_view, 5> of_mesh{"z_bounds", "direction", "triangle", "voxel", "wavenumber_bounds"};

std::vector<std::string> dimensions_of(hid_t dataset, std::size_t rank) {
  std::vector<std::string> names;
  const auto take = [](hid_t, unsigned, hid_t scale, void* result) -> herr_t {
    std::array<char, 1024> name{};
    if (H5Iget_name(scale, name.data(), name.size()) < 0) return -1;
    const std::string_view path(name.data());
    static_cast<std::vector<std::string>*>(result)->emplace_back(path.substr(path.rfind('/') + 1));
    return 0;
  };
  for (unsigned axis = 0; axis < rank; ++axis)
    check(H5DSiterate_scales(dataset, axis, nullptr, take, &names), "read a variable's dimensions");
  return names;
}

BlockVariable::Type type_of(hid_t dataset) {
  const Handle type(H5Dget_type(dataset), H5Tclose, "read a type");
  const bool wide = H5Tget_size(type) == sizeof(double);
  if (H5Tget_class(type) == H5T_FLOAT) return wide ? BlockVariable::Type::float64 : BlockVariable::Type::float32;
  return wide ? BlockVariable::Type::int64 : BlockVariable::Type::int32;
}

hid_t memory_type(BlockVariable::Type type) {
  switch (type) {
    case BlockVariable::Type::float32:
      return H5T_NATIVE_FLOAT;
    case BlockVariable::Type::float64:
      return H5T_NATIVE_DOUBLE;
    case BlockVariable::Type::int32:
      return H5T_NATIVE_INT32;
    case BlockVariable::Type::int64:
      break;
  }
  return H5T_NATIVE_INT64;
}

Stored read_stored(hid_t group, const std::string& name) {
  const Handle dataset = hdf5::open_dataset(group, name.c_str());
  Stored stored{name, {}, hdf5::shape_of(dataset), type_of(dataset), stored_attributes(dataset)};
  stored.is_coordinate = check(H5DSis_scale(dataset), "look at a variable") > 0;
  if (stored.is_coordinate) {
    std::array<char, 64> scale{};
    check(H5DSget_scale_name(dataset, scale.data(), scale.size()), "look at a coordinate");
    stored.is_length = std::string_view(scale.data()).starts_with("This is a netCDF dimension");
  } else {
    stored.dimensions = dimensions_of(dataset, stored.shape.size());
  }
  stored.is_mesh = std::find(of_mesh.begin(), of_mesh.end(), name) != of_mesh.end();
  if (stored.is_coordinate || stored.is_mesh) {
    Digest digest;
    for (const hsize_t length : stored.shape) digest.add(length);
    if (!stored.is_length) {
      const std::vector<std::byte> values = values_of(dataset);
      digest.add_bytes(values.data(), values.size());
    }
    stored.contents = digest.value();
  }
  if (stored.shape.empty()) {
    check(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &stored.scalar), "read a variable");
  }
  return stored;
}

bool is_group(hid_t location, const std::string& name) {
  const Handle object(H5Oopen(location, name.c_str(), H5P_DEFAULT), H5Oclose, "look into a file");
  return H5Iget_type(object) == H5I_GROUP;
}

}  // namespace

std::vector<std::byte> values_of(hid_t dataset) {
  const hid_t type = memory_type(type_of(dataset));
  std::vector<std::byte> values(hdf5::value_count(dataset) * H5Tget_size(type));
  if (!values.empty()) check(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "read a variable");
  return values;
}

std::vector<Attribute> stored_attributes(hid_t object) {
  std::vector<Attribute> attributes;
  for (const std::string& name : attribute_names(object)) {
    if (std::find(of_scales.begin(), of_scales.end(), name) == of_scales.end())
      attributes.push_back({name, value_of(object, name)});
  }
  return attributes;
}

std::vector<StoredGroup> read_groups(hid_t file) {
  std::vector<StoredGroup> groups(1);
  std::vector<std::string> names;
  for (const std::string& name : hdf5::member_names(file, H5_INDEX_CRT_ORDER)) {
    if (is_group(file, name)) {
      names.push_back(name);
    } else {
      groups.front().variables.push_back(read_stored(file, name));
    }
  }
  for (const std::string& name : names) {
    const Handle group = hdf5::open_group(file, name.c_str());
    StoredGroup read{name, stored_attributes(group), {}};
    for (const std::string& variable : hdf5::member_names(group, H5_INDEX_CRT_ORDER))
      read.variables.push_back(read_stored(group, variable));
    groups.push_back(std::move(read));
  }
  return groups;
}

}  // namespace cloudbow
