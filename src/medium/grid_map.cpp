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

void GridMap::add_air(const AirBlocks& from, AirBlocks shape) {
  shape.first_cell = static_cast<std::uint32_t>(cell.size());
  air.push_back(shape);
  for (int y = 0; y < shape.y; ++y) {
    for (int x = 0; x < shape.x; ++x) cell.push_back(from.first_cell + static_cast<std::uint32_t>(y * from.x + x));
  }
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
  if (!grid.air.empty()) other.air = std::move(map.air);
  if (!other.air.empty()) other.air_error = grid.air_error;
  other.absorption = picked(grid.absorption, map.cell);
  for (const auto& scattering : grid.scattering) other.scattering.push_back(picked(scattering, map.cell));
  if (grid.emits()) {
    other.planck = picked(grid.planck, map.cell);
    other.planck_step = picked(grid.planck_step, map.cell);
  }
  if (!grid.layer_planck.empty()) {
    other.layer_planck = picked(grid.layer_planck, map.level);
    other.layer_planck_step = picked(grid.layer_planck_step, map.level);
  }
  other.layer_absorption = picked(grid.layer_absorption, map.level);
  for (const auto& scattering : grid.layer_scattering) other.layer_scattering.push_back(picked(scattering, map.level));
  mark_uniform_levels(other);
  return other;
}

namespace {

// Below level `end` every voxel with matter gets its own cell; with `empty_ones` every voxel.
OpticalGrid with_own_cells(const OpticalGrid& grid, bool empty_ones, int end) {
  const BoxGrid& box = grid.box;
  GridMap map;
  map.box = box;
  map.level = same_levels(grid);
  std::vector<std::uint32_t> row(box.nx);
  for (int k = 0; k < box.nz(); ++k) {
    const AirBlocks air = k < end ? grid.air_of(k) : AirBlocks{};
    for (int j = 0; j < box.ny; ++j) {
      for (int i = 0; i < box.nx; ++i) row[i] = air.count() > 0 ? air.cell(i, j) : GridMap::no_cell;
      for (const RowSpan& span : grid.row(k, j))
        std::iota(row.begin() + span.i, row.begin() + span.i + span.n, span.offset);
      for (int i = 0; i < box.nx; ++i) {
        if (empty_ones || row[i] != GridMap::no_cell) map.add(i, row[i]);
      }
      map.end_row();
    }
    if (end < box.nz()) map.add_air(k < end ? AirBlocks{} : grid.air_of(k));
  }
  return remap(grid, std::move(map));
}

}  // namespace

OpticalGrid with_empty_cells(const OpticalGrid& grid) { return with_own_cells(grid, true, grid.box.nz()); }

OpticalGrid without_air_blocks(const OpticalGrid& grid, int end) { return with_own_cells(grid, false, end); }

}  // namespace cloudbow
