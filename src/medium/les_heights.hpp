// Heights of the levels of an LES file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "les_coordinates.hpp"

namespace cloudbow {

/// Heights of one level after the other as the file has them, in m; means over the columns if these differ.
struct LesHeights {
  std::string name;
  std::vector<double> value;
  bool are_edges = false;
  bool count_cells = false;            ///< as in LesCoordinates
  std::vector<double> of_columns_m{};  ///< [level][j][i], levels in the order of the file, if columns differ
};

struct LesHeightSearch {
  std::optional<LesHeights> heights;
  std::string problem;   ///< of the coordinate of the vertical axis
  bool descend = false;  ///< of that coordinate: the last level is the lowest
};

/// Searches the model's own fields of heights, the coordinate of the vertical axis, WRF's geopotential, then other
/// heights and geopotentials. z is not reversed yet. @throws InputError if a height is missing or not finite.
LesHeightSearch find_heights(LesFile& file, const LesAxes& axes);

}  // namespace cloudbow
