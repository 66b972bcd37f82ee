#include "transport/reduction/uniform_axes.hpp"

#include <algorithm>

#include "cloudbow/medium/grid_map.hpp"
#include "cloudbow/transport/output_fields.hpp"
#include "transport/grid/cells.hpp"

namespace cloudbow {
namespace {

// All coefficients of n cells from a on equal those from b on.
bool same_cells(const OpticalGrid& grid, std::size_t a, std::size_t b, std::size_t n) {
  const auto same = [=](const std::vector<float>& of) {
    return std::equal(of.begin() + a, of.begin() + a + n, of.begin() + b);
  };
  return same(grid.absorption) && (!grid.emits() || (same(grid.planck) && same(grid.planck_step))) &&
         std::all_of(grid.scattering.begin(), grid.scattering.end(), same);
}

bool full_rows_of_one_value(const OpticalGrid& grid) {
  const int nx = grid.box.nx;
  return std::all_of(grid.spans.begin(), grid.spans.end(), [&](const RowSpan& span) {
    return span.i == 0 && span.n == nx &&
           same_cells(grid, span.offset, span.offset + 1, static_cast<std::size_t>(nx - 1));
  });
}

bool rows_alike(const OpticalGrid& grid) {
  const auto alike = [&grid](const RowSpan& a, const RowSpan& b) {
    return a.i == b.i && a.n == b.n && same_cells(grid, a.offset, b.offset, static_cast<std::size_t>(a.n));
  };
  for (int k = 0; k < grid.box.nz(); ++k) {
    const auto first = grid.row(k, 0);
    for (int j = 1; j < grid.box.ny; ++j) {
      const auto other = grid.row(k, j);
      if (!std::equal(first.begin(), first.end(), other.begin(), other.end(), alike)) return false;
    }
  }
  return true;
}

// A map [ny][nx], or none, does not vary along an axis.
bool map_is_uniform(const std::vector<float>& map, const BoxGrid& box, bool along_x) {
  for (std::size_t c = 0; c < map.size(); ++c) {
    const std::size_t i = c % box.nx;
    if (map[c] != map[along_x ? c - i : i]) return false;
  }
  return true;
}

// [..][ny][nx] of the solved field, with the axes that it lacks.
template <class Value>
void spread_field(std::vector<Value>& field, int nx, int ny, UniformAxes uniform) {
  if (field.empty()) return;
  const int from_x = uniform.x ? 1 : nx;
  const int from_y = uniform.y ? 1 : ny;
  const std::size_t planes = field.size() / (static_cast<std::size_t>(from_x) * from_y);
  std::vector<Value> whole;
  whole.reserve(planes * nx * ny);
  for (std::size_t p = 0; p < planes; ++p) {
    for (int j = 0; j < ny; ++j) {
      const std::size_t row = (p * from_y + (uniform.y ? 0 : j)) * from_x;
      for (int i = 0; i < nx; ++i) whole.push_back(field[row + (uniform.x ? 0 : i)]);
    }
  }
  field = std::move(whole);
}

void spread_radiance_field(const Problem& whole, UniformAxes uniform, RadianceField& field) {
  const BoxGrid& box = whole.grid.box;
  const int nx = uniform.x ? 1 : box.nx;
  const int ny = uniform.y ? 1 : box.ny;
  const std::size_t points = field.direction.size();
  std::vector<std::size_t> place(static_cast<std::size_t>(nx) * ny * box.nz());
  for (std::size_t v = 0; v < field.voxel.size(); ++v)
    place[(static_cast<std::size_t>(field.voxel[v][2]) * ny + field.voxel[v][1]) * nx + field.voxel[v][0]] = v;
  RadianceField spread_out;
  spread_out.direction = std::move(field.direction);
  spread_out.triangle = std::move(field.triangle);
  const std::size_t columns = box.columns();
  for (const std::uint32_t c : dense_indices(whole.grid)) {
    const auto i = static_cast<std::int32_t>(c % box.nx);
    const auto j = static_cast<std::int32_t>(c / box.nx % box.ny);
    const auto k = static_cast<std::int32_t>(c / columns);
    spread_out.voxel.push_back({i, j, k});
    const std::size_t from = place[(static_cast<std::size_t>(k) * ny + (uniform.y ? 0 : j)) * nx + (uniform.x ? 0 : i)];
    const float* const radiance = field.radiance.data() + from * points;
    spread_out.radiance.insert(spread_out.radiance.end(), radiance, radiance + points);
  }
  field = std::move(spread_out);
}

}  // namespace

UniformAxes uniform_axes(const Problem& problem) {
  const OpticalGrid& grid = problem.grid;
  if (!grid.box.periodic) return {};
  const auto maps_are_uniform = [&](bool along_x) {
    return map_is_uniform(problem.surface.albedo_map, grid.box, along_x) &&
           map_is_uniform(problem.surface.planck_map, grid.box, along_x);
  };
  return {grid.box.nx > 1 && maps_are_uniform(true) && full_rows_of_one_value(grid),
          grid.box.ny > 1 && maps_are_uniform(false) && rows_alike(grid)};
}

Problem collapse(const Problem& problem, UniformAxes uniform) {
  const bool one_column = (uniform.x || problem.grid.box.nx == 1) && (uniform.y || problem.grid.box.ny == 1);
  if (one_column && !problem.grid.air.empty()) {
    Problem with_own_cells = problem;
    with_own_cells.grid = without_air_blocks(problem.grid);
    return collapse(with_own_cells, uniform);
  }
  Problem small{{}, problem.phase, problem.sun, problem.sky_radiance, problem.surface};
  const OpticalGrid& from = problem.grid;
  GridMap map;
  map.box = from.box;
  if (uniform.x) {
    map.box.dx_m *= map.box.nx;
    map.box.nx = 1;
  }
  if (uniform.y) {
    map.box.dy_m *= map.box.ny;
    map.box.ny = 1;
  }
  map.level = same_levels(from);
  for (int k = 0; k < map.box.nz(); ++k) {
    for (int j = 0; j < map.box.ny; ++j) {
      for (const RowSpan& span : from.row(k, j)) {
        for (int n = 0; n < (uniform.x ? 1 : span.n); ++n)
          map.add(span.i + n, span.offset + static_cast<std::uint32_t>(n));
      }
      map.end_row();
    }
    AirBlocks air = from.air_of(k);
    if (uniform.x && air.count() > 0) air.x = air.width_x = 1;
    if (uniform.y && air.count() > 0) air.y = air.width_y = 1;
    map.add_air(from.air_of(k), air);
  }
  const BoxGrid box = map.box;
  small.grid = remap(from, std::move(map));
  for (auto of_surface : {&Surface::albedo_map, &Surface::planck_map}) {
    const std::vector<float>& whole = problem.surface.*of_surface;
    if (whole.empty()) continue;
    std::vector<float>& of_columns = small.surface.*of_surface;
    of_columns.clear();
    for (int j = 0; j < box.ny; ++j) {
      const auto row = whole.begin() + static_cast<std::ptrdiff_t>(j) * from.box.nx;
      of_columns.insert(of_columns.end(), row, row + box.nx);
    }
  }
  return small;
}

void spread(const Problem& whole, UniformAxes uniform, Solution& solution) {
  const BoxGrid& box = whole.grid.box;
  solution.box = box;
  for (const OutputField& field : output_fields()) spread_field(solution.*field.values, box.nx, box.ny, uniform);
  for (RadianceImage& image : solution.images) {
    if (image.view.width == 0) spread_field(image.radiance, box.nx, box.ny, uniform);
  }
  if (solution.radiance_field) spread_radiance_field(whole, uniform, *solution.radiance_field);
}

}  // namespace cloudbow
