#include "cloudbow/transport/probe_columns.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "transport/reduction/thick_levels.hpp"

namespace cloudbow {
namespace {

constexpr std::size_t kNotChosen = std::numeric_limits<std::size_t>::max();

/// Calls see(column, k, cell) for all active cells, in their order.
template <class See>
void for_each_cell(const OpticalGrid& grid, See see) {
  const BoxGrid& box = grid.box;
  for (int k = 0; k < box.nz(); ++k) {
    for (int j = 0; j < box.ny; ++j) {
      const std::size_t row = static_cast<std::size_t>(k) * box.ny + j;
      for (std::uint32_t s = grid.row_begin[row]; s < grid.row_begin[row + 1]; ++s) {
        const RowSpan& span = grid.spans[s];
        for (int n = 0; n < span.n; ++n)
          see(static_cast<std::size_t>(j) * box.nx + span.i + n, k, span.offset + static_cast<std::size_t>(n));
      }
    }
  }
}

std::vector<double> optical_depths(const OpticalGrid& grid) {
  std::vector<double> depth(grid.box.columns());
  for_each_cell(grid, [&](std::size_t column, int k, std::size_t c) {
    double extinction = grid.absorption[c];
    for (const auto& of_phase : grid.scattering) extinction += static_cast<double>(of_phase[c]);
    depth[column] += grid.box.thickness_m(k) * extinction;
  });
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
  std::vector<std::size_t> place(from.box.columns(), kNotChosen);
  for (std::size_t n = 0; n < chosen.size(); ++n) place[chosen[n]] = n;
  // Cells of each level by their place in the row.
  std::vector<std::vector<std::size_t>> cell(from.box.nz(), std::vector<std::size_t>(chosen.size(), kNotChosen));
  for_each_cell(from, [&](std::size_t column, int k, std::size_t c) {
    if (place[column] != kNotChosen) cell[k][place[column]] = c;
  });

  OpticalGrid& to = row.grid;
  to.box = from.box;
  to.box.nx = static_cast<int>(chosen.size());
  to.box.ny = 1;
  to.box.periodic = true;
  to.layer_absorption = from.layer_absorption;
  to.layer_scattering = from.layer_scattering;
  to.scattering.resize(from.scattering.size());
  to.row_begin.push_back(0);
  for (const std::vector<std::size_t>& level : cell) {
    for (std::size_t i = 0; i < level.size(); ++i) {
      if (level[i] == kNotChosen) continue;
      if (i == 0 || level[i - 1] == kNotChosen)
        to.spans.push_back({static_cast<int>(i), 0, static_cast<std::uint32_t>(to.absorption.size())});
      ++to.spans.back().n;
      to.absorption.push_back(from.absorption[level[i]]);
      for (std::size_t p = 0; p < to.scattering.size(); ++p) to.scattering[p].push_back(from.scattering[p][level[i]]);
    }
    to.row_begin.push_back(static_cast<std::uint32_t>(to.spans.size()));
  }
  return row;
}

}  // namespace

Problem probe_columns(const Problem& problem, const SolverOptions& options) {
  const std::vector<double> depth = optical_depths(problem.grid);
  std::vector<std::size_t> order(depth.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return depth[a] < depth[b]; });
  const std::size_t classes = std::min(most_probe_columns, order.size());
  std::vector<std::size_t> chosen;
  for (std::size_t n = 0; n < classes; ++n) chosen.push_back(order[(2 * n + 1) * order.size() / (2 * classes)]);
  const Problem row = side_by_side(problem, chosen);
  const CutLevels cut = cut_thick_levels(problem, options);
  return cut.added(problem.grid.box) > 0 ? with_cut_levels(row, cut) : row;
}

}  // namespace cloudbow
