// Two-dimensional fields from files of others: HDF5 (netCDF-4 too) and PNG.
#pragma once

#include <filesystem>
#include <vector>

namespace cloudbow {

struct Raster {
  int nx = 0;
  int ny = 0;
  std::vector<float> value;  ///< [ny][nx], y ascending
};

/// HDF5: the dataset `name` with dimensions (y, x), y ascending; where there is none of that name, the only
/// two-dimensional dataset of the root. PNG: grey level / 255 (colours are first turned to grey), 8 bits; the picture's
/// lowest line is y = 0.
/// @throws InputError naming the file, what was found and what is allowed.
Raster read_raster(const std::filesystem::path& file, const char* name);

/// Means over nx x ny equal cells that cover the raster's area: the raster's mean is kept.
std::vector<float> area_means(const Raster& raster, int nx, int ny);

}  // namespace cloudbow
