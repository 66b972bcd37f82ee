#include "io/netcdf4_file.hpp"

#include <fmt/format.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <functional>
#include <limits>
#include <numeric>
#include <type_traits>

#include "io/deflated_chunks.hpp"

namespace cloudbow::netcdf4 {

using hdf5::check;
using hdf5::dataspace;
using hdf5::Handle;
using hdf5::memory_type;

namespace {

constexpr unsigned creation_order = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;
constexpr std::size_t compress_from_bytes = 1 << 16;  // below, chunks cost more than they save

template <typename T>
hid_t file_type() {
  if constexpr (std::is_same_v<T, float>) return H5T_IEEE_F32LE;
  if constexpr (std::is_same_v<T, double>) return H5T_IEEE_F64LE;
  if constexpr (std::is_same_v<T, std::int32_t>) return H5T_STD_I32LE;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_STD_I64LE;
}

void write_array(hid_t object, const std::string& name, hid_t stored, hid_t memory, const void* value, hid_t space) {
  Handle attribute(H5Acreate2(object, name.c_str(), stored, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                   "create an attribute");
  check(H5Awrite(attribute, memory, value), "write an attribute");
  attribute.close();
}

void write_scalar(hid_t object, const std::string& name, hid_t stored, hid_t memory, const void* value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "create a dataspace");
  write_array(object, name, stored, memory, value, space);
}

/// Text of fixed length: a char attribute of netCDF, which every reader supports.
void write_text(hid_t object, const std::string& name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "create a text type");
  check(H5Tset_size(type, std::max<std::size_t>(1, text.size())), "set a text's length");
  check(H5Tset_cset(type, H5T_CSET_UTF8), "set a text's encoding");
  write_scalar(object, name, type, type, text.c_str());
}

Handle creation_properties() {
  Handle properties = hdf5::property_list(H5P_DATASET_CREATE);
  check(H5Pset_attr_creation_order(properties, creation_order), "track attributes");
  check(H5Pset_obj_track_times(properties, false), "leave out times");
  return properties;
}

template <typename T>
constexpr BlockVariable::Type type_of() {
  if constexpr (std::is_same_v<T, float>) return BlockVariable::Type::float32;
  if constexpr (std::is_same_v<T, double>) return BlockVariable::Type::float64;
  if constexpr (std::is_same_v<T, std::int32_t>) return BlockVariable::Type::int32;
  if constexpr (std::is_same_v<T, std::int64_t>) return BlockVariable::Type::int64;
}

/// Calls use(T()) with the number's type in C++.
template <class Use>
auto with_type(BlockVariable::Type type, const Use& use) {
  switch (type) {
    case BlockVariable::Type::float32:
      return use(float());
    case BlockVariable::Type::float64:
      return use(double());
    case BlockVariable::Type::int32:
      return use(std::int32_t());
    case BlockVariable::Type::int64:
      break;
  }
  return use(std::int64_t());
}

std::vector<hsize_t> lengths(hid_t group, const std::vector<std::string>& dimensions) {
  std::vector<hsize_t> shape;
  for (const std::string& dimension : dimensions)
    shape.push_back(hdf5::value_count(hdf5::open_dataset(group, dimension.c_str())));
  return shape;
}

void attach_scales(hid_t group, hid_t dataset, const std::vector<std::string>& dimensions) {
  for (unsigned axis = 0; axis < dimensions.size(); ++axis) {
    Handle scale = hdf5::open_dataset(group, dimensions[axis].c_str());
    check(H5DSattach_scale(dataset, scale, axis), "attach a dimension scale");
    scale.close();
  }
}

template <typename T>
void write(hid_t group, const char* name, const std::vector<std::string>& dimensions, std::span<const T> values,
           const std::vector<Attribute>& attributes) {
  BlockVariable variable(group, name, dimensions, 0, type_of<T>(), attributes);
  variable.write({}, std::as_bytes(values));
  variable.close();
}

Handle text_dataset(hid_t group, const char* name, const std::vector<hsize_t>& shape,
                    std::span<const std::string> texts) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "create a text type");
  check(H5Tset_size(type, H5T_VARIABLE), "set a text's length");
  check(H5Tset_cset(type, H5T_CSET_UTF8), "set a text's encoding");
  std::vector<const char*> pointers;
  for (const std::string& text : texts) pointers.push_back(text.c_str());
  const Handle properties = creation_properties();
  const Handle space = dataspace(shape);
  Handle dataset(H5Dcreate2(group, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose,
                 "create a variable");
  if (!pointers.empty())
    check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()), "write a variable");
  return dataset;
}

}  // namespace

Handle create_group(hid_t parent, const char* name) {
  const Handle properties = hdf5::property_list(H5P_GROUP_CREATE);
  check(H5Pset_link_creation_order(properties, creation_order), "track links");
  check(H5Pset_attr_creation_order(properties, creation_order), "track attributes");
  check(H5Pset_obj_track_times(properties, false), "leave out times");
  return {H5Gcreate2(parent, name, H5P_DEFAULT, properties, H5P_DEFAULT), H5Gclose, "create a group"};
}

void write_attribute(hid_t object, const Attribute& attribute) {
  std::visit(
      [&](const auto& value) {
        using T = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<T, std::string>) {
          write_text(object, attribute.name, value);
        } else if constexpr (requires { typename T::value_type; }) {
          using Number = typename T::value_type;
          const Handle space = dataspace({value.size()});
          write_array(object, attribute.name, file_type<Number>(), memory_type<Number>(), value.data(), space);
        } else {
          write_scalar(object, attribute.name, file_type<T>(), memory_type<T>(), &value);
        }
      },
      attribute.value);
}

void write_attributes(hid_t object, const std::vector<Attribute>& attributes) {
  for (const Attribute& attribute : attributes) write_attribute(object, attribute);
}

void write_coordinate(hid_t group, const char* name, std::span<const double> values,
                      const std::vector<Attribute>& attributes) {
  const Handle properties = creation_properties();
  const Handle space = dataspace({values.size()});
  Handle dataset(H5Dcreate2(group, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose,
                 "create a coordinate");
  check(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "write a coordinate");
  check(H5DSset_scale(dataset, name), "make a dimension scale");
  write_attributes(dataset, attributes);
  dataset.close();
}

void write_scalar_coordinate(hid_t group, const char* name, double value, const std::vector<Attribute>& attributes) {
  const Handle properties = creation_properties();
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "create a dataspace");
  Handle dataset(H5Dcreate2(group, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose,
                 "create a coordinate");
  check(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value), "write a coordinate");
  write_attributes(dataset, attributes);
  dataset.close();
}

void write_dimension(hid_t group, const char* name, std::size_t size) {
  // The scale's name and type mark a dimension without variable (netCDF-4 format specification). No value is stored.
  const Handle properties = creation_properties();
  const Handle space = dataspace({size});
  Handle dataset(H5Dcreate2(group, name, H5T_IEEE_F32BE, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose,
                 "create a dimension");
  const std::string mark = fmt::format("This is a netCDF dimension but not a netCDF variable. {:9}", size);
  check(H5DSset_scale(dataset, mark.c_str()), "make a dimension scale");
  dataset.close();
}

void write_variable(hid_t group, const char* name, const std::vector<std::string>& dimensions,
                    std::span<const float> values, const std::vector<Attribute>& attributes) {
  write(group, name, dimensions, values, attributes);
}

void write_variable(hid_t group, const char* name, const std::vector<std::string>& dimensions,
                    std::span<const double> values, const std::vector<Attribute>& attributes) {
  write(group, name, dimensions, values, attributes);
}

void write_variable(hid_t group, const char* name, const std::vector<std::string>& dimensions,
                    std::span<const std::int32_t> values, const std::vector<Attribute>& attributes) {
  write(group, name, dimensions, values, attributes);
}

void write_variable(hid_t group, const char* name, const std::vector<std::string>& dimensions,
                    std::span<const std::int64_t> values, const std::vector<Attribute>& attributes) {
  write(group, name, dimensions, values, attributes);
}

void write_variable(hid_t group, const char* name, const std::vector<std::string>& dimensions,
                    std::span<const std::string> texts, const std::vector<Attribute>& attributes) {
  Handle dataset = text_dataset(group, name, lengths(group, dimensions), texts);
  attach_scales(group, dataset, dimensions);
  write_attributes(dataset, attributes);
  dataset.close();
}

void write_coordinate(hid_t group, const char* name, std::span<const std::string> texts,
                      const std::vector<Attribute>& attributes) {
  Handle dataset = text_dataset(group, name, {texts.size()}, texts);
  check(H5DSset_scale(dataset, name), "make a dimension scale");
  write_attributes(dataset, attributes);
  dataset.close();
}

BlockVariable::BlockVariable(hid_t group, const char* name, const std::vector<std::string>& dimensions,
                             std::size_t leading, Type type, const std::vector<Attribute>& attributes)
    : type_(type), dataset_(create(group, name, dimensions, leading)) {
  attach_scales(group, dataset_, dimensions);
  with_type(type, [&]<class T>(T) {
    if constexpr (std::is_floating_point_v<T>)
      write_attribute(dataset_, {"_FillValue", std::numeric_limits<T>::quiet_NaN()});
  });
  write_attributes(dataset_, attributes);
}

Handle BlockVariable::create(hid_t group, const char* name, const std::vector<std::string>& dimensions,
                             std::size_t leading) {
  const std::vector<hsize_t> shape = lengths(group, dimensions);
  block_.assign(shape.begin() + static_cast<std::ptrdiff_t>(leading), shape.end());
  return with_type(type_, [&]<class T>(T) {
    const Handle properties = creation_properties();
    const hsize_t values = std::accumulate(block_.begin(), block_.end(), hsize_t{1}, std::multiplies<>());
    if (values * sizeof(T) >= compress_from_bytes) {
      chunk_ = hdf5::chunk_shape(block_, sizeof(T));
      std::vector<hsize_t> whole(leading, 1);
      whole.insert(whole.end(), chunk_.begin(), chunk_.end());
      hdf5::set_deflated_chunks(properties, whole);
    }
    if constexpr (std::is_floating_point_v<T>) {
      const T fill = std::numeric_limits<T>::quiet_NaN();
      check(H5Pset_fill_value(properties, memory_type<T>(), &fill), "set the fill value");
    }
    const Handle space = dataspace(shape);
    return Handle(H5Dcreate2(group, name, file_type<T>(), space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose,
                  "create a variable");
  });
}

void BlockVariable::write(const std::vector<hsize_t>& leading, std::span<const std::byte> values) {
  if (values.empty()) return;
  with_type(type_, [&]<class T>(T) {
    assert(values.size() == sizeof(T) * std::accumulate(block_.begin(), block_.end(), hsize_t{1}, std::multiplies<>()));
    if (!chunk_.empty()) {
      static_assert(std::endian::native == std::endian::little, "chunks are written in the file's byte order");
      hdf5::write_deflated(dataset_, block_, chunk_, values, sizeof(T), leading);
    } else if (leading.empty()) {
      check(H5Dwrite(dataset_, memory_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "write a variable");
    } else {
      hdf5::Block place{leading, std::vector<hsize_t>(leading.size(), 1)};
      place.start.resize(leading.size() + block_.size(), 0);
      place.size.insert(place.size.end(), block_.begin(), block_.end());
      hdf5::write_block(dataset_, place, memory_type<T>(), values.data());
    }
  });
}

}  // namespace cloudbow::netcdf4
