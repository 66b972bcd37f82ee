// Maps of the ground, its albedo and its temperature, from files of others: PNG, netCDF, HDF5.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

namespace cloudbow {

struct GroundMap {
  int nx = 0;
  int ny = 0;
  std::vector<float> value;  ///< [ny][nx], x and y ascending: albedo, 0 to 1, or temperature, K
  /// Along x and y, if the file has coordinates in metres or kilometres.
  std::array<std::optional<double>, 2> length_m{};
};

/// A map of at most 2.5e7 values.
///
/// PNG: grey level over the largest, of 1 to 16 bits, without gamma; the picture's lowest line is y = 0. Colours and
/// palettes are read if all pixels are grey, alpha if all are opaque.
///
/// netCDF, classic or netCDF-4, and HDF5: the variable "albedo", or the only one of two dimensions; others of length 1
/// (time) may stand before or behind. Dimensions y, x, or the other way round if their names say so. Coordinates in
/// variables of the dimensions' names turn an axis that descends; without any, y and x ascend. scale_factor, add_offset
/// and units ("%") are obeyed.
/// @throws InputError naming the file, what was found, what is allowed and the remedy: not such a file, damaged,
/// pictures in colour, transparent pixels, missing values, values outside 0 to 1.
GroundMap read_albedo_map(const std::filesystem::path& file);

/// A map of temperature [K], in netCDF or HDF5 as above: the variable "surface_temperature" or "temperature", or the
/// only one of two dimensions, in kelvin.
/// @throws InputError as above; for PNG; for values outside 100 to 1000 K.
GroundMap read_temperature_map(const std::filesystem::path& file);

/// A map of another size, by its own coordinates, belongs to another site.
/// @param file for the message.
/// @throws InputError if the map has coordinates and they are off by more than 1 % or a cell.
void check_covers(const GroundMap& map, const std::filesystem::path& file, const std::array<double, 2>& domain_m);

/// Means over nx x ny equal cells that cover the map's area: the map's mean is kept.
std::vector<float> area_means(const GroundMap& map, int nx, int ny);

}  // namespace cloudbow
