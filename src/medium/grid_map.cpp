#include "cloudbow/medium/grid_map.hpp"

#include <numeric>
#include <utility>

namespace cloudbow {
namespace {

std::vector<float> picked(const std::vector<float>& of, const std::vector<std::uint32_t>& cell) {
  std::vector<float> values;
  values.reserve(cell.size());
  for (const std::uint32_t c : cell) values.push_back(c == GridMap::no_cell ? 0.F : of[c]);
  return values;
}

std::vector<double> picked(const std::vector<double>& of, const std::vector<int>& level) {
  std::vector<double> values;
  values.reserve(level.size());
  for (const int k : level) values.push_back(of[k]);
  return values;
}

}  // namespace

void GridMap::add(std::int32_t i, std::uint32_t from) {
  const bool extends = spans.size() > row_begin.back() && spans.back().i + spans.back().n == i;
  if (!extends) spans.push_back({i, 0, static_cast<std::uint32_t>(cell.size())});
  ++spans.back().n;
  cell.push_back(from);
}

std::vector<int> same_levels(const OpticalGrid& grid) {
  std::vector<int> level(grid.box.nz());
  std::iota(level.begin(), level.end(), 0);
  return level;
}

OpticalGrid remap(const OpticalGrid& grid, GridMap map) {
  OpticalGrid other;
  other.box = std::move(map.box);
  other.row_begin = std::move(map.row_begin);
  other.spans = std::move(map.spans);
  other.absorption = picked(grid.absorption, map.cell);
  for (const auto& scattering : grid.scattering) other.scattering.push_back(picked(scattering, map.cell));
  other.layer_absorption = picked(grid.layer_absorption, map.level);
  for (const auto& scattering : grid.layer_scattering) other.layer_scattering.push_back(picked(scattering, map.level));
  return other;
}

OpticalGrid with_empty_cells(const OpticalGrid& grid) {
  const BoxGrid& box = grid.box;
  GridMap map;
  map.box = box;
  map.level = same_levels(grid);
  std::vector<std::uint32_t> row(box.nx);
  for (int k = 0; k < box.nz(); ++k) {
    for (int j = 0; j < box.ny; ++j) {
      row.assign(box.nx, GridMap::no_cell);
      for (const RowSpan& span : grid.row(k, j))
        std::iota(row.begin() + span.i, row.begin() + span.i + span.n, span.offset);
      for (int i = 0; i < box.nx; ++i) map.add(i, row[i]);
      map.end_row();
    }
  }
  return remap(grid, std::move(map));
}

}  // namespace cloudbow
