#include "transport/rays/path_pattern.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace cloudbow {
namespace {

struct Slope {
  double x;  // columns crossed per metre of height
  double y;
};

Slope horizontal_slope(const BoxGrid& box, const Direction& travel, bool independent_columns) {
  Slope slope{travel.x() / std::abs(travel.z()) / box.dx_m, travel.y() / std::abs(travel.z()) / box.dy_m};
  if (independent_columns || (box.periodic && box.nx == 1)) slope.x = 0;
  if (independent_columns || (box.periodic && box.ny == 1)) slope.y = 0;
  return slope;
}

double fraction(double x) { return x - std::floor(x); }

// Level fraction at which the ray meets the next face of cell `cell` along one axis.
double next_face(double position, double slope, int cell) {
  if (std::abs(slope) < 1e-12) return std::numeric_limits<double>::infinity();
  return ((slope > 0 ? cell + 1 : cell) - position) / slope;
}

// The cell that the ray is in at the end of the level.
int last_cell(double position, double slope, int cell) {
  constexpr double end = 1 - 1e-9;  // a face met at the level's end is crossed in the next level
  if (std::abs(slope) < 1e-12) return cell;
  const double at = position + slope * end;
  return slope > 0 ? std::max(cell, static_cast<int>(std::ceil(at)) - 1)
                   : std::min(cell, static_cast<int>(std::floor(at)));
}

}  // namespace

double pattern_segments(const BoxGrid& box, const Direction& travel, bool independent_columns, LevelRange levels) {
  const Slope per_metre = horizontal_slope(box, travel, independent_columns);
  double height_m = 0;
  for (int k = levels.first; k < levels.last; ++k) height_m += box.is_uniform(k) ? 0 : box.thickness_m(k);
  return height_m * (std::abs(per_metre.x) + std::abs(per_metre.y)) + levels.last - levels.first + 3;
}

PathPattern make_path_pattern(const BoxGrid& box, const Direction& travel, double start_x, double start_y,
                              bool independent_columns, LevelRange levels) {
  assert(travel.z() != 0);
  const Slope per_metre = horizontal_slope(box, travel, independent_columns);
  PathPattern pattern;
  pattern.upward = travel.z() > 0;
  pattern.first_level = levels.first;
  double x = start_x;
  double y = start_y;
  int cell_x = 0;
  int cell_y = 0;
  Entry entry = Entry::none;
  const int count = levels.last - levels.first;
  pattern.segments.reserve(static_cast<std::size_t>(pattern_segments(box, travel, independent_columns, levels)));
  pattern.mean_place.reserve(static_cast<std::size_t>(count));
  for (auto* list : {&pattern.chord_m, &pattern.x, &pattern.y}) list->reserve(static_cast<std::size_t>(count) + 1);
  pattern.level_begin.reserve(static_cast<std::size_t>(count) + 1);
  pattern.x.push_back(x);
  pattern.y.push_back(y);
  for (int step = 0; step < count; ++step) {
    const int k = pattern.upward ? levels.first + step : levels.last - 1 - step;
    const double height = box.thickness_m(k);
    const double tx = per_metre.x * height;
    const double ty = per_metre.y * height;
    const double side = pattern.upward ? 1 : -1;
    pattern.level_begin.push_back(static_cast<std::uint32_t>(pattern.segments.size()));
    pattern.chord_m.push_back(height / std::abs(travel.z()));
    if (box.is_uniform(k)) {
      cell_x = last_cell(x, tx, cell_x);
      cell_y = last_cell(y, ty, cell_y);
      pattern.segments.push_back({cell_x, cell_y, entry, 1., {0, 0, -side / 2}, {0, 0, side / 2}});
      pattern.mean_place.push_back({0., 0.});
      entry = Entry::none;
      x += tx;
      y += ty;
      pattern.x.push_back(x);
      pattern.y.push_back(y);
      continue;
    }
    for (double t = 0;;) {
      const double to_x = next_face(x, tx, cell_x);
      const double to_y = next_face(y, ty, cell_y);
      const double face = std::min(to_x, to_y);
      const bool last = face >= 1 - 1e-9;  // a face met at the level's end is crossed in the next level
      const double end = last ? 1. : std::max(t, face);
      pattern.segments.push_back({cell_x,
                                  cell_y,
                                  entry,
                                  end - t,
                                  {x + tx * t - cell_x - .5, y + ty * t - cell_y - .5, side * (t - .5)},
                                  {x + tx * end - cell_x - .5, y + ty * end - cell_y - .5, side * (end - .5)}});
      entry = Entry::none;
      if (last) break;
      if (to_x <= to_y) {
        cell_x += tx > 0 ? 1 : -1;
        entry = tx > 0 ? Entry::x_low : Entry::x_high;
      } else {
        cell_y += ty > 0 ? 1 : -1;
        entry = ty > 0 ? Entry::y_low : Entry::y_high;
      }
      t = end;
    }
    double mean_x = 0;
    double mean_y = 0;
    double mean_z = 0;
    for (std::size_t s = pattern.level_begin.back(); s < pattern.segments.size(); ++s) {
      const Segment& segment = pattern.segments[s];
      mean_x += segment.fraction * .5 * (segment.from[0] + segment.to[0]);
      mean_y += segment.fraction * .5 * (segment.from[1] + segment.to[1]);
      mean_z += segment.fraction * .5 * (segment.from[2] + segment.to[2]);
    }
    for (std::size_t s = pattern.level_begin.back(); s < pattern.segments.size(); ++s) {
      Segment& segment = pattern.segments[s];
      for (auto* end : {&segment.from, &segment.to}) {
        (*end)[0] -= mean_x;
        (*end)[1] -= mean_y;
        (*end)[2] -= mean_z;
      }
    }
    pattern.mean_place.push_back({mean_x, mean_y});
    x += tx;
    y += ty;
    pattern.x.push_back(x);
    pattern.y.push_back(y);
  }
  pattern.level_begin.push_back(static_cast<std::uint32_t>(pattern.segments.size()));
  return pattern;
}

PathPattern at_true_places(PathPattern pattern) {
  for (int step = 0; step < pattern.levels(); ++step) {
    for (std::uint32_t s = pattern.level_begin[step]; s < pattern.level_begin[step + 1]; ++s) {
      for (auto* end : {&pattern.segments[s].from, &pattern.segments[s].to}) {
        (*end)[0] += pattern.mean_place[step][0];
        (*end)[1] += pattern.mean_place[step][1];
      }
    }
    pattern.mean_place[step] = {0., 0.};
  }
  return pattern;
}

StartFraction start_for_centred_exit(const BoxGrid& box, const Direction& travel, bool independent_columns,
                                     LevelRange levels) {
  const Slope per_metre = horizontal_slope(box, travel, independent_columns);
  const double height = box.z_edge_m[levels.last] - box.z_edge_m[levels.first];
  return {fraction(.5 - per_metre.x * height), fraction(.5 - per_metre.y * height)};
}

}  // namespace cloudbow
