#include "app/scene/accuracy.hpp"

#include <algorithm>
#include <array>
#include <cassert>

namespace cloudbow {
namespace {

struct Level {
  const char* name;
  int control_points;
  const char* directions;
  int delta_m_order;
  int beam_delta_m_order;
  int exact_moments;
  int beam_half_range_rows;
  bool minimax;
  int gather_directions;
  int beam_rays;
  int column_streams;
  double max_level_optical_depth;
  double max_column_optical_depth;
  int max_column_parts;
  double tolerance;
  double class_tolerance;
};

constexpr std::array<Level, 4> ladder{{
    {"draft", 42, "double-gauss-6x8", 6, 8, 2, 2, true, 128, 4, 4, 0, 0, 1, 1e-3, 3e-3},
    {"balanced", 162, "double-gauss-8x16", 8, 12, 3, 3, true, 512, 16, 8, 2, 2, 3, 1e-4, 1e-3},
    {"fine", 162, "double-gauss-12x24", 10, 14, 3, 3, true, 2048, 64, 12, 1, 1.5, 4, 1e-5, 2e-4},
    {"reference", 642, "double-gauss-18x36", 16, 20, 5, 3, false, 4096, 64, 16, .5, 1, 4, 1e-6, 2e-5},
}};
// A single column costs next to nothing, so it gets more directions. Fewer azimuths near the pole serve vertical fluxes
// well, horizontal ones worse: for columns only.
constexpr std::array<Level, 2> column_ladder{{
    {"balanced", 162, "reduced-double-gauss-12x20", 12, 16, 3, 3, true, 512, 16, 12, 1, 0, 1, 1e-4, 1e-3},
    {"fine", 642, "double-gauss-16x24", 14, 18, 3, 3, true, 2048, 16, 14, .5, 0, 1, 1e-5, 2e-4},
}};
// A slice costs little, so it gets more polar angles: walls of clouds under a low sun need them.
struct SliceOrdinates {
  const char* accuracy;
  const char* directions;
};
constexpr std::array<SliceOrdinates, 2> slice_ladder{{
    {"balanced", "double-gauss-12x16"},
    {"fine", "double-gauss-16x24"},
}};
constexpr int measured_beam_excess = 2;

}  // namespace

std::vector<std::string> accuracy_names() {
  std::vector<std::string> names;
  for (const Level& level : ladder) names.emplace_back(level.name);
  return names;
}

double class_tolerance(const std::string& accuracy) {
  const auto* const level =
      std::find_if(ladder.begin(), ladder.end(), [&](const Level& l) { return accuracy == l.name; });
  assert(level != ladder.end());
  return level->class_tolerance;
}

SolverOptions accuracy_options(const std::string& name, HorizontalExtent extent, bool measured_phase_functions) {
  const bool one_column = extent == HorizontalExtent::column;
  const auto called = [&name](const Level& level) { return name == level.name; };
  const auto* const for_column = std::find_if(column_ladder.begin(), column_ladder.end(), called);
  const auto* const for_any = std::find_if(ladder.begin(), ladder.end(), called);
  assert(for_any != ladder.end());
  const Level& level = one_column && for_column != column_ladder.end() ? *for_column : *for_any;

  SolverOptions options;
  options.control_points = level.control_points;
  options.directions = level.directions;
  for (const SliceOrdinates& ordinates : slice_ladder) {
    if (extent == HorizontalExtent::slice && name == ordinates.accuracy) options.directions = ordinates.directions;
  }
  options.fit.delta_m_order = level.delta_m_order;
  options.fit.beam_delta_m_order =
      measured_phase_functions ? level.delta_m_order + measured_beam_excess : level.beam_delta_m_order;
  options.fit.exact_moments = level.exact_moments;
  options.fit.beam_half_range_rows = level.beam_half_range_rows;
  options.fit.minimax = level.minimax;
  options.gather_directions = level.gather_directions;
  options.beam_rays = level.beam_rays;
  options.column_streams = level.column_streams;
  options.max_level_optical_depth = level.max_level_optical_depth;
  options.max_column_optical_depth = level.max_column_optical_depth;
  options.max_column_parts = level.max_column_parts;
  options.tolerance = level.tolerance;
  options.double_precision = one_column;
  return options;
}

}  // namespace cloudbow
