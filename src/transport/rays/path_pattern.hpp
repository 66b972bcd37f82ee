// The path of one direction through the levels of a box, shared by all its rays. Rays start at the same fraction of
// every column. In a level, each thus crosses the same short list of segments. The list is made once per direction
// (docs/theory.md, "Shared pattern").
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cloudbow/medium/optical_grid.hpp"
#include "cloudbow/sphere/control_points.hpp"
#include "transport/grid/cells.hpp"

namespace cloudbow {

/// Face through which a ray comes into a segment.
enum class Entry : std::int8_t { none, x_low, x_high, y_low, y_high };

/// A stretch of the ray in one cell. Its cell is the launch column shifted by (shift_x, shift_y).
struct Segment {
  int shift_x;
  int shift_y;
  Entry entry;      ///< x_low: through the face at the cell's lower x, coming from the neighbour below
  double fraction;  ///< of the level's chord; the fractions of a level sum to 1
  /// Its entry and exit of the cell, in cell units from the centre, less the level's chord-weighted mean. A linear
  /// source then keeps the cell's mean source exactly.
  std::array<double, 3> from;
  std::array<double, 3> to;
};

struct PathPattern {
  bool upward;
  int first_level;                         ///< lowest level crossed
  std::vector<std::uint32_t> level_begin;  ///< in marching order, levels() + 1
  std::vector<Segment> segments;
  std::vector<double> chord_m;  ///< [level in marching order] thickness / |mu|
  /// [level in marching order] the mean, along x and y, that the places of its segments lack.
  std::vector<std::array<double, 2>> mean_place;
  /// Position after each level (levels() + 1, the first is the start) in columns from the launch column's lower corner.
  std::vector<double> x;
  std::vector<double> y;

  int levels() const { return static_cast<int>(chord_m.size()); }
  /// Index k of a level of the marching order.
  int level(int step) const { return first_level + (upward ? step : levels() - 1 - step); }
  /// Columns from the launch column to the one the ray is in after `step` levels.
  int shift_x(int step) const { return step == 0 ? 0 : segments[level_begin[step] - 1].shift_x; }
  int shift_y(int step) const { return step == 0 ? 0 : segments[level_begin[step] - 1].shift_y; }
};

/// @param travel direction of the march, travel.z != 0.
/// @param start_x, start_y start within the launch column, in [0, 1).
/// @param independent_columns light stays in its column (independent columns): horizontal motion is ignored, chords are
/// not. A periodic axis of one column is not crossed either: the field does not vary along it. A uniform level has one
/// segment, which lies in the column that the rays leave it by.
PathPattern make_path_pattern(const BoxGrid& box, const Direction& travel, double start_x, double start_y,
                              bool independent_columns, LevelRange levels);

/// The same with the places of its segments from the centres of their cells. For rays of many directions: they fill a
/// cell together, and each of them sees the linear source as it is.
PathPattern at_true_places(PathPattern pattern);

/// Segments of that pattern, at most: known before it is made.
double pattern_segments(const BoxGrid& box, const Direction& travel, bool independent_columns, LevelRange levels);

/// Start fraction at which rays leave the last level at the centre of a column.
struct StartFraction {
  double x;
  double y;
};
StartFraction start_for_centred_exit(const BoxGrid& box, const Direction& travel, bool independent_columns,
                                     LevelRange levels);

}  // namespace cloudbow
