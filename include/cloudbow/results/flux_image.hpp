// One map or section out of a result file, as a picture needs it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cloudbow {

/// Values on a rectangle of cells, seen with the first axis to the right and the second upwards: a horizontal map (x,
/// y) or, where the result has one row or column of cells only, a vertical section (x or y, z).
struct FluxImage {
  std::string variable;
  std::string units;
  std::string place;  ///< "z = 3000 m" for a map, "section x-z" for a section
  int columns = 0;
  int rows = 0;
  std::vector<float> value;  ///< [row][column], row 0 at the bottom; NaN: no value
  double column_width_m = 1;
  std::vector<double> row_edge_m;  ///< rows + 1, ascending
};

/// Reads a root variable of shape (y, x), (z, y, x) or (level, y, x).
/// @param level "top", "bottom" or a height in metres between them, of which the nearest level is taken; sections
/// ignore it.
/// @throws InputError where the file is no result, or it lacks the variable (the message lists what is there) or the
/// level.
FluxImage read_flux_image(const std::filesystem::path& result_file, const std::string& variable,
                          const std::string& level);

}  // namespace cloudbow
