#include "cloudbow/transport/probe_columns.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "cloudbow/medium/grid_map.hpp"
#include "transport/reduction/subdivided_levels.hpp"

namespace cloudbow {
namespace {

constexpr std::size_t not_chosen = std::numeric_limits<std::size_t>::max();

std::vector<double> optical_depths(const OpticalGrid& grid) {
  std::vector<double> depth(grid.box.columns());
  grid.for_each_place(
      [&](int k, std::size_t column, std::size_t c) { depth[column] += grid.box.thickness_m(k) * grid.extinction(c); });
  return depth;
}

/// The columns of one row, in the order listed.
Problem side_by_side(const Problem& problem, const std::vector<std::size_t>& chosen) {
  const OpticalGrid& from = problem.grid;
  Problem row{{}, problem.phase, problem.sun, problem.sky_radiance, {}};
  row.surface.albedo = problem.surface.albedo;
  for (const std::size_t column : chosen) {
    if (!problem.surface.albedo_map.empty()) row.surface.albedo_map.push_back(problem.surface.albedo_map[column]);
  }
  std::vector<std::size_t> location(from.box.columns(), not_chosen);
  for (std::size_t n = 0; n < chosen.size(); ++n) location[chosen[n]] = n;
  // Cells of each level by their location in the row.
  std::vector<std::vector<std::uint32_t>> cell(from.box.nz(),
                                               std::vector<std::uint32_t>(chosen.size(), GridMap::no_cell));
  from.for_each_place([&](int k, std::size_t column, std::size_t c) {
    if (location[column] != not_chosen) cell[k][location[column]] = static_cast<std::uint32_t>(c);
  });
  GridMap map;
  map.box = from.box;
  map.box.nx = static_cast<int>(chosen.size());
  map.box.ny = 1;
  map.box.periodic = true;
  map.level = same_levels(from);
  for (const std::vector<std::uint32_t>& level : cell) {
    for (std::size_t i = 0; i < level.size(); ++i) {
      if (level[i] != GridMap::no_cell) map.add(static_cast<std::int32_t>(i), level[i]);
    }
    map.end_row();
  }
  row.grid = remap(from, std::move(map));
  return row;
}

}  // namespace

Problem probe_columns(const SolvePlan& plan) {
  const Problem& problem = plan.whole();
  const std::vector<double> depth = optical_depths(problem.grid);
  std::vector<std::size_t> order(depth.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return depth[a] < depth[b]; });
  const std::size_t classes = std::min(most_probe_columns, order.size());
  std::vector<std::size_t> chosen;
  for (std::size_t n = 0; n < classes; ++n) chosen.push_back(order[(2 * n + 1) * order.size() / (2 * classes)]);
  const Problem row = side_by_side(problem, chosen);
  return plan.added_levels() > 0 ? with_subdivided_levels(row, plan.levels()) : row;
}

}  // namespace cloudbow
