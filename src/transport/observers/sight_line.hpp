// One line of sight through the cells: the formal solution from an eye at any place in any direction, with a source
// that is linear within each cell (docs/theory.md, "Radiance").
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "cloudbow/core/not_negative.hpp"
#include "transport/observers/gather.hpp"
#include "transport/rays/exponential_functions.hpp"

namespace cloudbow {

/// What lines of sight cross. Cells are looked up by place: index [(k*ny + j)*nx + i], no_cell where none is active.
template <class Real>
struct SightScene {
  static constexpr std::uint32_t no_cell = std::numeric_limits<std::uint32_t>::max();

  /// What a line reads of a cell, side by side in memory.
  struct Cell {
    Real extinction;
    std::array<Real, 3> gradient;  ///< relative, of the source, along x, y, z
  };

  const BoxGrid& box;
  const GroundRadiance<Real>& ground;
  double sky_radiance = 0;
  SideRadiance side_radiance;  ///< what open sides show, by interface; may be empty
  std::vector<Cell> cells;     ///< [n]
  std::vector<std::uint32_t> cell_at;
  double x_max_m, y_max_m;

  /// @param gradient [n] relative, of the source, along x, y, z
  SightScene(const BoxGrid& box_of, const Cells<Real>& cells_of, const std::array<const Real*, 3>& gradient,
             const GroundRadiance<Real>& ground_of, double sky, SideRadiance side)
      : box(box_of),
        ground(ground_of),
        sky_radiance(sky),
        side_radiance(std::move(side)),
        cells(cells_of.size()),
        cell_at(box.columns() * static_cast<std::size_t>(box.nz()), no_cell),
        x_max_m(box.x_min_m + box.nx * box.dx_m),
        y_max_m(box.y_min_m + box.ny * box.dy_m) {
    const std::vector<std::uint32_t> dense = dense_indices(cells_of.rows);
    for (std::size_t c = 0; c < dense.size(); ++c) {
      cell_at[dense[c]] = static_cast<std::uint32_t>(c);
      cells[c] = {cells_of.extinction[c], {gradient[0][c], gradient[1][c], gradient[2][c]}};
    }
  }
};

namespace sight {

constexpr double seen_through = 1e-4;  // what is transmitted after this is taken to be as bright as what is before it
/// Level lines never leave periodic air: they end after so many domains, with the sky.
constexpr int most_domains = 2000;

/// What an open side shows at a height, for light that travels along `travel`.
template <class Real>
double beside(const SightScene<Real>& scene, const Eigen::Vector3d& place, const Direction& travel) {
  if (!scene.side_radiance) return travel.z() < 0 ? scene.sky_radiance : 0.;
  const std::vector<double> by_edge = scene.side_radiance(travel);
  const auto& edge = scene.box.z_edge_m;
  const auto upper = std::upper_bound(edge.begin() + 1, edge.end() - 1, place.z());
  const std::size_t k = static_cast<std::size_t>(upper - edge.begin()) - 1;
  const double share = std::clamp((place.z() - edge[k]) / (edge[k + 1] - edge[k]), 0., 1.);
  return (1 - share) * by_edge[k] + share * by_edge[k + 1];
}

/// Distance along the line to where it enters [low, high] on one axis, and to where it leaves it.
inline void clip(double from, double along, double low, double high, double& enter, double& leave) {
  if (along == 0) {
    if (from < low || from > high) leave = -1;
    return;
  }
  const double a = (low - from) / along;
  const double b = (high - from) / along;
  enter = std::max(enter, std::min(a, b));
  leave = std::min(leave, std::max(a, b));
}

}  // namespace sight

/// Radiance seen from `eye` looking along the unit vector `sight`, W m-2 sr-1.
/// @param source (cell) -> source of that cell towards the eye.
template <class Real, class Source>
double seen_along(const SightScene<Real>& scene, const Eigen::Vector3d& eye, const Direction& sight,
                  const Source& source) {
  const BoxGrid& box = scene.box;
  const Direction travel = -sight;
  double enter = 0;
  double leave = std::numeric_limits<double>::infinity();
  sight::clip(eye.z(), sight.z(), box.z_edge_m.front(), box.z_edge_m.back(), enter, leave);
  if (!box.periodic) {
    sight::clip(eye.x(), sight.x(), box.x_min_m, scene.x_max_m, enter, leave);
    sight::clip(eye.y(), sight.y(), box.y_min_m, scene.y_max_m, enter, leave);
  }
  if (leave <= enter) {  // past the domain: between it and the eye nothing is seen
    if (box.periodic || sight.z() >= 0) return scene.sky_radiance;
    return sight::beside(scene, {eye.x(), eye.y(), box.z_edge_m.front()}, travel);
  }

  // Cells along the line: place and step on each axis, distance from the eye to the next wall.
  const Eigen::Vector3d start = eye + enter * sight;
  const double x = (start.x() - box.x_min_m) / box.dx_m;
  const double y = (start.y() - box.y_min_m) / box.dy_m;
  const auto cell_of = [](double place, double along, int n, bool periodic) {
    double cell = std::floor(place);
    if (cell == place && along < 0) --cell;
    return periodic ? cell : std::clamp(cell, 0., n - 1.);
  };
  double ix = cell_of(x, sight.x(), box.nx, box.periodic);
  double iy = cell_of(y, sight.y(), box.ny, box.periodic);
  const auto wrapped = [](double cell, int n) {
    const double m = std::fmod(cell, n);
    return static_cast<int>(m < 0 ? m + n : m);
  };
  int i = wrapped(ix, box.nx);
  int j = wrapped(iy, box.ny);
  const auto above = std::upper_bound(box.z_edge_m.begin() + 1, box.z_edge_m.end() - 1, start.z());
  int k = static_cast<int>(above - box.z_edge_m.begin()) - 1;
  if (sight.z() < 0 && k > 0 && start.z() == box.z_edge_m[k]) --k;

  constexpr double never = std::numeric_limits<double>::infinity();
  const auto wall = [&](double from, double along, double low, double spacing, double cell) {
    return along == 0 ? never : (low + (cell + (along > 0 ? 1 : 0)) * spacing - from) / along;
  };
  const auto level_wall = [&](int level) {
    return sight.z() == 0 ? never : (box.z_edge_m[level + (sight.z() > 0 ? 1 : 0)] - eye.z()) / sight.z();
  };
  // A single periodic column has no walls.
  const double along_x = box.periodic && box.nx == 1 ? 0. : sight.x();
  const double along_y = box.periodic && box.ny == 1 ? 0. : sight.y();
  double next_x = wall(eye.x(), along_x, box.x_min_m, box.dx_m, ix);
  double next_y = wall(eye.y(), along_y, box.y_min_m, box.dy_m, iy);
  double next_z = level_wall(k);
  double at = enter;
  double transmitted = 1;
  double radiance = 0;
  for (int domains = 0;;) {
    const double next = std::min({next_x, next_y, next_z});
    const std::uint32_t cell = scene.cell_at[(static_cast<std::size_t>(k) * box.ny + j) * box.nx + i];
    if (cell != SightScene<Real>::no_cell && next > at) {
      const auto& gradient = scene.cells[cell].gradient;
      const Real t = std::min(scene.cells[cell].extinction * static_cast<Real>(next - at),
                              static_cast<Real>(largest_optical_path));
      const auto phi = exponential_functions(t);
      // Where the segment begins and ends, in cells from the centre of this one.
      const auto offsets = [&](double distance) {
        const Eigen::Vector3d place = eye + distance * sight;
        return static_cast<Real>(
            1 + static_cast<double>(gradient[0]) * ((place.x() - box.x_min_m) / box.dx_m - ix - .5) +
            static_cast<double>(gradient[1]) * ((place.y() - box.y_min_m) / box.dy_m - iy - .5) +
            static_cast<double>(gradient[2]) * ((place.z() - box.z_edge_m[k]) / box.thickness_m(k) - .5));
      };
      const Real near = not_negative(offsets(at));
      const Real far = not_negative(offsets(next));
      radiance += transmitted * static_cast<double>(t * (phi.phi2 * near + (phi.phi1 - phi.phi2) * far)) * source(cell);
      transmitted -= transmitted * static_cast<double>(t * phi.phi1);
      if (transmitted < sight::seen_through) return radiance / (1 - transmitted);
    }
    at = std::max(at, next);
    if (next == next_z) {
      k += sight.z() > 0 ? 1 : -1;
      if (k < 0) {
        return radiance +
               transmitted * static_cast<double>(scene.ground.at(travel, static_cast<std::size_t>(j) * box.nx + i));
      }
      if (k == box.nz()) return radiance + transmitted * scene.sky_radiance;
      next_z = level_wall(k);
      continue;
    }
    const bool through_x = next == next_x;
    int& column = through_x ? i : j;
    const int n = through_x ? box.nx : box.ny;
    const int way = (through_x ? sight.x() : sight.y()) > 0 ? 1 : -1;
    column += way;
    if (column < 0 || column == n) {
      if (!box.periodic) return radiance + transmitted * sight::beside(scene, eye + at * sight, travel);
      column = column < 0 ? n - 1 : 0;
      if (++domains == sight::most_domains) return radiance + transmitted * scene.sky_radiance;
    }
    if (through_x) {
      ix += way;
      next_x = wall(eye.x(), sight.x(), box.x_min_m, box.dx_m, ix);
    } else {
      iy += way;
      next_y = wall(eye.y(), sight.y(), box.y_min_m, box.dy_m, iy);
    }
  }
}

}  // namespace cloudbow
