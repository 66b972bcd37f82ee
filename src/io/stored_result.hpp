// A result file read back without knowledge of its variables, so that results can be joined.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/netcdf4_file.hpp"

namespace cloudbow {

/// A variable or coordinate of one result.
struct Stored {
  std::string name;
  std::vector<std::string> dimensions;  ///< of coordinates: none
  std::vector<hsize_t> shape;
  netcdf4::BlockVariable::Type type = netcdf4::BlockVariable::Type::float32;
  std::vector<netcdf4::Attribute> attributes;
  bool is_coordinate = false;
  bool is_length = false;      ///< a coordinate without values
  bool is_mesh = false;        ///< a variable that usually is the same in all runs, as bounds of cells
  std::uint64_t contents = 0;  ///< digest of shape and values, of coordinates and meshes
  double scalar = 0;           ///< the value, without dimensions
};

struct StoredGroup {
  std::string name;                            ///< empty: the root
  std::vector<netcdf4::Attribute> attributes;  ///< of the root: none
  std::vector<Stored> variables;
};

/// The root and the groups in it, in the order of their creation. @throws hdf5::Error if the file is damaged;
/// InputError if it can't be opened.
std::vector<StoredGroup> read_groups(hid_t file);

/// All values of a dataset in its own type.
std::vector<std::byte> values_of(hid_t dataset);

/// All attributes of a group or dataset in the order of their creation, without those of dimension scales and
/// `_FillValue`. @throws hdf5::Error if one is of another kind than write_attribute() writes.
std::vector<netcdf4::Attribute> stored_attributes(hid_t object);

}  // namespace cloudbow
