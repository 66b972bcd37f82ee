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

}  // namespace

std::vector<std::size_t> representative_columns(const OpticalGrid& grid, std::size_t count) {
  const std::vector<double> depth = optical_depths(grid);
  std::vector<std::size_t> order(depth.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return depth[a] < depth[b]; });
  const std::size_t classes = std::min(count, order.size());
  std::vector<std::size_t> chosen;
  for (std::size_t n = 0; n < classes; ++n) chosen.push_back(order[(2 * n + 1) * order.size() / (2 * classes)]);
  return chosen;
}

Problem side_by_side(const Problem& problem, std::span<const std::size_t> columns) {
  const OpticalGrid& from = problem.grid;
  Problem row{{}, problem.phase, problem.sun, problem.sky_radiance, {}};
  row.surface.albedo = problem.surface.albedo;
  row.surface.planck = problem.surface.planck;
  for (const std::size_t column : columns) {
    if (!problem.surface.albedo_map.empty()) row.surface.albedo_map.push_back(problem.surface.albedo_map[column]);
    if (!problem.surface.planck_map.empty()) row.surface.planck_map.push_back(problem.surface.planck_map[column]);
  }
  std::vector<std::size_t> location(from.box.columns(), not_chosen);
  for (std::size_t n = 0; n < columns.size(); ++n) location[columns[n]] = n;
  // Cells of each level by their location in the row.
  std::vector<std::vector<std::uint32_t>> cell(from.box.nz(),
                                               std::vector<std::uint32_t>(columns.size(), GridMap::no_cell));
  from.for_each_place([&](int k, std::size_t column, std::size_t c) {
    if (location[column] != not_chosen) cell[k][location[column]] = static_cast<std::uint32_t>(c);
  });
  GridMap map;
  map.box = from.box;
  map.box.nx = static_cast<int>(columns.size());
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

Problem probe_columns(const SolvePlan& plan) {
  const Problem& problem = plan.whole();
  const Problem row = side_by_side(problem, representative_columns(problem.grid, most_probe_columns));
  return plan.added_levels() > 0 ? with_subdivided_levels(row, plan.levels()) : row;
}

}  // namespace cloudbow
