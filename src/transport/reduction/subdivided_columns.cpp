#include "transport/reduction/subdivided_columns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "cloudbow/medium/grid_map.hpp"
#include "cloudbow/transport/output_fields.hpp"
#include "transport/reduction/fading_beam.hpp"

namespace cloudbow {
namespace {

constexpr double across_the_sun = 2;  // times the depth that parts may have along the sun's azimuth

// Delta-M scaled extinction, 1/m, mean over the cells by the power that the beam loses in them.
double lit_extinction(const Problem& problem, const SolverOptions& options) {
  double power = 0, sum = 0;
  follow_beam(problem, options, [&](int, double extinction, double lost, double voxels) {
    power += voxels * lost;
    sum += voxels * lost * extinction;
  });
  return power > 0 ? sum / power : 0;
}

int parts_for(double depth, double largest, int most) {
  return static_cast<int>(std::clamp(std::ceil(depth / largest - 1e-9), 1., static_cast<double>(most)));
}

// Means over blocks of columns of [..][ny][nx] values of the parts.
void join(const BoxGrid& box, SubdividedColumns parts, std::vector<float>& field) {
  if (field.empty()) return;
  const std::size_t fine_nx = static_cast<std::size_t>(box.nx) * parts.x;
  const std::size_t planes = field.size() / (fine_nx * box.ny * parts.y);
  std::vector<float> mean;
  mean.reserve(planes * box.columns());
  for (std::size_t p = 0; p < planes; ++p) {
    for (int j = 0; j < box.ny; ++j) {
      for (int i = 0; i < box.nx; ++i) {
        double sum = 0;
        for (int b = 0; b < parts.y; ++b) {
          const std::size_t row = (p * box.ny + j) * parts.y + b;
          for (int a = 0; a < parts.x; ++a)
            sum += static_cast<double>(field[row * fine_nx + static_cast<std::size_t>(i) * parts.x + a]);
        }
        mean.push_back(static_cast<float>(sum / (parts.x * parts.y)));
      }
    }
  }
  field = std::move(mean);
}

void join(SubdividedColumns parts, RadianceField& field) {
  const std::size_t points = field.direction.size();
  std::map<std::array<std::int32_t, 3>, std::size_t> place;  // by k, j, i: the order of cells
  std::vector<std::array<std::int32_t, 3>> voxel;
  const auto key_of = [&](const std::array<std::int32_t, 3>& part) {
    return std::array<std::int32_t, 3>{part[2], part[1] / parts.y, part[0] / parts.x};
  };
  for (const auto& part : field.voxel) place.try_emplace(key_of(part), 0);
  for (auto& [key, at] : place) {
    at = voxel.size();
    voxel.push_back({key[2], key[1], key[0]});
  }
  std::vector<double> sum(voxel.size() * points, 0.);
  for (std::size_t v = 0; v < field.voxel.size(); ++v) {
    double* const to = sum.data() + place.at(key_of(field.voxel[v])) * points;
    for (std::size_t m = 0; m < points; ++m)
      to[m] += static_cast<double>(field.radiance[v * points + m]) / (parts.x * parts.y);
  }
  field.voxel = std::move(voxel);
  field.radiance.assign(sum.begin(), sum.end());
}

}  // namespace

SubdividedColumns subdivide_thick_columns(const Problem& problem, const SolverOptions& options) {
  const double largest = options.max_column_optical_depth;
  const BoxGrid& box = problem.grid.box;
  if (!(largest > 0) || !has_fading_light(problem) || options.independent_columns) return {};
  const double extinction = lit_extinction(problem, options);
  const auto parts_along = [&](int count, double width_m, double along_sun) {
    if (box.periodic && count == 1) return 1;  // nothing varies along it
    const double limit = largest * (1 + (across_the_sun - 1) * (1 - along_sun));
    return parts_for(extinction * width_m, limit, options.max_column_parts);
  };
  const Direction sun = problem.sun ? problem.sun->travel : -Direction::UnitZ();
  const double across = std::hypot(sun.x(), sun.y());
  const double x = across > 0 ? std::pow(sun.x() / across, 2) : .5;
  return {parts_along(box.nx, box.dx_m, x), parts_along(box.ny, box.dy_m, 1 - x)};
}

Problem with_subdivided_columns(const Problem& problem, SubdividedColumns parts) {
  Problem fine{{}, problem.phase, problem.sun, problem.sky_radiance, problem.surface};
  const BoxGrid& box = problem.grid.box;
  GridMap map;
  map.box = box;
  map.box.nx *= parts.x;
  map.box.ny *= parts.y;
  map.box.dx_m /= parts.x;
  map.box.dy_m /= parts.y;
  map.level = same_levels(problem.grid);
  for (int k = 0; k < box.nz(); ++k) {
    for (int j = 0; j < map.box.ny; ++j) {
      for (const RowSpan& span : problem.grid.row(k, j / parts.y)) {
        for (int n = 0; n < span.n; ++n) {
          for (int a = 0; a < parts.x; ++a)
            map.add((span.i + n) * parts.x + a, span.offset + static_cast<std::uint32_t>(n));
        }
      }
      map.end_row();
    }
    const AirBlocks air = problem.grid.air_of(k);
    map.add_air(air, {0, air.x, air.y, air.width_x * parts.x, air.width_y * parts.y});
  }
  fine.grid = remap(problem.grid, std::move(map));
  for (auto of_surface : {&Surface::albedo_map, &Surface::planck_map}) {
    const std::vector<float>& whole = problem.surface.*of_surface;
    if (whole.empty()) continue;
    std::vector<float>& of_parts = fine.surface.*of_surface;
    of_parts.clear();
    for (int j = 0; j < fine.grid.box.ny; ++j) {
      for (int i = 0; i < fine.grid.box.nx; ++i)
        of_parts.push_back(whole[static_cast<std::size_t>(j / parts.y) * box.nx + i / parts.x]);
    }
  }
  return fine;
}

void join_columns(const Problem& whole, SubdividedColumns parts, Solution& solution) {
  const BoxGrid& box = whole.grid.box;
  for (const OutputField& field : output_fields()) join(box, parts, solution.*field.values);
  for (RadianceImage& image : solution.images) {
    if (image.view.width == 0) join(box, parts, image.radiance);
  }
  if (solution.radiance_field) join(parts, *solution.radiance_field);
  solution.box = box;
  solution.report.active_voxels = whole.grid.active_cells();
}

}  // namespace cloudbow
