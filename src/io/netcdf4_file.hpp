// HDF5 written as netCDF-4 requires: dimension scales on every axis, order of creation tracked, fill values,
// attributes.
#pragma once

#include <cstddef>
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
/// A coordinate without dimension, float64.
void write_scalar_coordinate(hid_t group, const char* name, double value, const std::vector<Attribute>& attributes);
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

void write_variable(hid_t group, const char* name, const std::vector<std::string>& dimensions,
                    std::span<const std::int64_t> values, const std::vector<Attribute>& attributes);
/// Texts of any length (NC_STRING).
void write_variable(hid_t group, const char* name, const std::vector<std::string>& dimensions,
                    std::span<const std::string> texts, const std::vector<Attribute>& attributes);
/// A dimension whose coordinate variable holds texts.
void write_coordinate(hid_t group, const char* name, std::span<const std::string> texts,
                      const std::vector<Attribute>& attributes);

/// Variables that are written block by block.
class BlockVariable {
 public:
  enum class Type { float32, float64, int32, int64 };

  /// @param leading number of dimensions in front, each of whose index combinations is one block. Blocks that are large
  /// are chunked, shuffled and deflated. Floats that are not written are NaN.
  BlockVariable(hid_t group, const char* name, const std::vector<std::string>& dimensions, std::size_t leading,
                Type type, const std::vector<Attribute>& attributes);

  /// @param values in the type of the variable, bytes in the machine's order
  void write(const std::vector<hsize_t>& leading, std::span<const std::byte> values);
  void close() { dataset_.close(); }

 private:
  hdf5::Handle create(hid_t group, const char* name, const std::vector<std::string>& dimensions, std::size_t leading);

  Type type_;
  std::vector<hsize_t> block_;
  std::vector<hsize_t> chunk_;  ///< of a block; empty: contiguous
  hdf5::Handle dataset_;
};

}  // namespace cloudbow::netcdf4
