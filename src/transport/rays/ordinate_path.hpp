// The path of the ordinates through a box: along z, or along x or y through runs of levels of one thickness. Those are
// taken if they have fewer segments and voxels are thin (docs/theory.md, "March along the dominant axis"). Once per
// solve.
#pragma once

#include <algorithm>
#include <vector>

#include "cloudbow/sphere/ordinate_set.hpp"
#include "transport/rays/sideways_march.hpp"

namespace cloudbow {

struct OrdinatePath {
  /// In the order of travel: patterns along z, each of them but the last followed by a march sideways. A pattern
  /// between two neighbouring runs has no levels.
  std::vector<PathPattern> along_z;
  std::vector<SidewaysPath> sideways;
  bool upward = false;
  double cost = 0;  ///< in runs of cells crossed, about

  bool goes_along_x() const {
    return std::any_of(sideways.begin(), sideways.end(), [](const SidewaysPath& run) { return run.axis == 0; });
  }
};

/// How a field of thick voxels is marched: with the several rays per voxel of marches along z, or the cheapest way.
enum class ThickVoxels { sampled, cheapest };

template <class Real>
std::vector<OrdinatePath> make_ordinate_paths(const BoxGrid& box, const Cells<Real>& cells,
                                              const std::vector<Direction>& travel, bool independent_columns,
                                              ThickVoxels thick = ThickVoxels::sampled);

}  // namespace cloudbow
