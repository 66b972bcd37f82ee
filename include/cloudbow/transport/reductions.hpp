// Reductions of a problem before it is solved.
#pragma once

#include <vector>

#include "cloudbow/medium/optical_grid.hpp"

namespace cloudbow {

/// Horizontal axes along which nothing varies, of more than one cell.
struct UniformAxes {
  bool x = false;
  bool y = false;
  bool any() const { return x || y; }
};

/// The levels of a box, some of them in parts.
struct SubdividedLevels {
  std::vector<double> z_edge_m;  ///< of the parts, ascending
  std::vector<int> level;        ///< [parts] the level that each is of

  int added(const BoxGrid& box) const { return static_cast<int>(level.size()) - box.nz(); }
};

/// Equal parts of every column along x and y.
struct SubdividedColumns {
  int x = 1;
  int y = 1;
  bool any() const { return x > 1 || y > 1; }
  bool operator==(const SubdividedColumns&) const = default;
};

}  // namespace cloudbow
