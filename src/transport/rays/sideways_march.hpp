// Marching the rays of a slanted direction along x or y, sheet by sheet. A ray then crosses two or three segments per
// cell. A march along z crosses as many columns as the slant requires (docs/theory.md, "March along the dominant
// axis").
//
// In a sheet, rays form rows by height, one per cell. A row is identified by its launch level q. It is counted in the
// direction of vertical travel, from the level that light enters first. After s crossings of levels the row is in level
// q + s. Rows q < 0 begin outside and enter later. After the last sheet the rays are back at the first, rise levels
// further. They continue from the launch points by linear interpolation between rows and columns, which conserves their
// power. A block has as many rows as lie between a row and its successor. So its input is complete before it.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "transport/grid/cells.hpp"
#include "transport/rays/march.hpp"
#include "transport/rays/path_pattern.hpp"

namespace cloudbow {

/// One direction through the levels [first, last), of one thickness, of a box with periodic sides.
struct SidewaysPath {
  int axis = 1;  ///< 0: along x, 1: along y
  /// Of the box turned so that the sheets are its levels and the levels its y. Runs of levels of one thickness share
  /// it.
  std::shared_ptr<const PathPattern> pattern;
  LevelRange levels;
  bool upward = true;  ///< light travels up
  double rise = 0;     ///< levels crossed in a sheet, > 0
  int block = 0;       ///< whole levels crossed in all sheets, >= 1
  double rest = 0;     ///< and the fraction of one more
  int across = 0;      ///< columns crossed in all sheets, whole, by the launch column of a ray that leaves
  double across_rest = 0;
  bool ascending_across = true;
};

/// @param levels of one thickness. @returns nothing if rays do not move along it, or return before they cross a level.
std::optional<SidewaysPath> make_sideways_path(const BoxGrid& box, const Direction& travel, int axis,
                                               LevelRange levels);

/// Light through the horizontal planes of a sideways march; planes are by sheet and column across: [sheet][column].
template <class Real>
struct SidewaysPlanes {
  std::span<const Real> entering;  ///< radiance through the plane that light comes in by; empty: the same,
  Real everywhere = 0;             ///< this, in all columns
  std::span<Real> leaving;         ///< mean radiance through the other plane is added to it; empty: not kept
  double left = 0;                 ///< its sum over the columns is added
  std::span<double> at_level;      ///< [levels + 1] by height, sum over the columns, is added; empty: not kept
};

template <class Real>
struct SidewaysWorkspace {
  std::vector<Real> rays, row;
};

/// @param sheets along the axis, rows by level of the box, columns across; @param gaps as these, of the air.
/// @param source [n], sums as for march(), in the sheets' order of cells.
template <class Real>
void march_sideways(const SidewaysPath& path, const Sheets& sheets, const Sheets& gaps, const CellView<Real>& cells,
                    const Real* source, SidewaysPlanes<Real>& planes, const CellSums<Real>& sums,
                    SidewaysWorkspace<Real>& work);

}  // namespace cloudbow
