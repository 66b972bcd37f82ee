// Readers of maps by the form of their file; they leave the values unchecked.
#pragma once

#include "cloudbow/medium/albedo_map.hpp"
#include "import_parts.hpp"
#include "les_vocabulary.hpp"

namespace cloudbow {

/// 100 MB: many more than any domain has columns.
inline constexpr double most_map_values = 2.5e7;

/// @throws InputError before memory is taken.
inline void check_map_size(const std::filesystem::path& file, double nx, double ny) {
  if (nx * ny >= 1 && nx * ny <= most_map_values) return;
  fail_import(file,
              "wrong size (found {} x {} values, allowed 1 to {:.3g} in all) a map needs about one value a column", nx,
              ny, most_map_values);
}

/// Meaning of a map's values.
struct MapQuantity {
  const char* name;
  std::vector<const char*> variables;  ///< names in netCDF, the first that is there
  UnitTable units;
};

/// True if the file begins as a PNG does.
bool is_png(const std::filesystem::path& file);

GroundMap read_png_map(const std::filesystem::path& file);
/// Missing values are NaN.
GroundMap read_netcdf_map(const std::filesystem::path& file, const MapQuantity& quantity);

}  // namespace cloudbow
