// One line of sight through the cells: the formal solution from any position in any direction. The source is linear
// within each cell (docs/theory.md, "Radiance").
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "cloudbow/core/not_negative.hpp"
#include "transport/gather/gather.hpp"
#include "transport/rays/cell_walk.hpp"
#include "transport/rays/crossing.hpp"

namespace cloudbow {

/// The medium of the lines of sight. Cells are looked up by location: index [(k*ny + j)*nx + i], no_cell if none is
/// active.
template <class Real>
struct SightScene {
  static constexpr std::uint32_t no_cell = std::numeric_limits<std::uint32_t>::max();

  /// Data of a cell of linear source that a line reads, adjacent in memory.
  struct Cell {
    Real extinction;
    std::array<Real, 3> gradient;  ///< relative, of the source, along x, y, z
  };

  const BoxGrid& box;
  const GroundRadiance<Real>& ground;
  double sky_radiance = 0;
  SideRadiance side_radiance;                              ///< radiance at open sides, by interface; may be empty
  std::vector<Cell> linear_cells;                          ///< [n]; empty: the source is constant in each cell,
  std::array<std::vector<Cell>, octants> cells_of_octant;  ///< in place of them for travel in an octant; empty: not
  std::vector<Real> constant_extinction;                   ///< [n] whose extinction, 1/m, is this
  std::vector<std::uint32_t> cell_at;
  double x_max_m, y_max_m;

  /// @param gradient [n] relative, of the source, along x, y, z; null: the source is constant in each cell.
  SightScene(const BoxGrid& box_of, const Cells<Real>& cells_of, const std::array<const Real*, 3>& gradient,
             const GroundRadiance<Real>& ground_of, double sky, SideRadiance side)
      : box(box_of),
        ground(ground_of),
        sky_radiance(sky),
        side_radiance(std::move(side)),
        cell_at(box.columns() * static_cast<std::size_t>(box.nz()), no_cell),
        x_max_m(box.x_min_m + box.nx * box.dx_m),
        y_max_m(box.y_min_m + box.ny * box.dy_m) {
    for_each_place(cells_of.rows, [&](std::uint32_t cell, std::size_t place) { cell_at[place] = cell; });
    if (gradient[0] == nullptr) {
      constant_extinction.assign(cells_of.extinction.begin(),
                                 cells_of.extinction.begin() + static_cast<std::ptrdiff_t>(cells_of.size()));
      return;
    }
    linear_cells = joined(cells_of, gradient);
  }

  /// For light that travels in this octant. @param gradient as that of the constructor, not null.
  void set_octant(int octant, const Cells<Real>& cells_of, const std::array<const Real*, 3>& gradient) {
    cells_of_octant[octant] = joined(cells_of, gradient);
  }
  /// The cells for light that travels so; empty: the source is constant in each cell.
  const std::vector<Cell>& cells_along(const Direction& travel) const {
    const std::vector<Cell>& own = cells_of_octant[octant_of(travel)];
    return own.empty() ? linear_cells : own;
  }

  /// Crossing::emitted of the cell that the line crosses, relative to the cell's source. Light enters at the point at
  /// which the line leaves.
  static Real emitted(const Crossing<Real>& crossing, const std::array<Real, 3>& gradient, const CellWalk& walk) {
    const auto relative_source = [&](double distance) {
      const Eigen::Vector3d place = walk.from_centre(distance);
      return not_negative(static_cast<Real>(1 + static_cast<double>(gradient[0]) * place.x() +
                                            static_cast<double>(gradient[1]) * place.y() +
                                            static_cast<double>(gradient[2]) * place.z()));
    };
    const Real near = relative_source(walk.entry());
    const Real far = relative_source(walk.exit());
    return crossing.emitted(far, near);
  }

 private:
  static std::vector<Cell> joined(const Cells<Real>& cells_of, const std::array<const Real*, 3>& gradient) {
    std::vector<Cell> cells;
    cells.reserve(cells_of.size());
    for (std::size_t c = 0; c < cells_of.size(); ++c)
      cells.push_back({cells_of.extinction[c], {gradient[0][c], gradient[1][c], gradient[2][c]}});
    return cells;
  }
};

namespace sight {

constexpr double seen_through = 1e-4;  // beyond this transmission, brightness is taken to be that before it

/// Radiance at an open side at the height z, for light that travels along `travel`.
template <class Real>
double beside(const SightScene<Real>& scene, double z, const Direction& travel) {
  if (!scene.side_radiance) return travel.z() < 0 ? scene.sky_radiance : 0.;
  const std::vector<double> by_edge = scene.side_radiance(travel);
  const auto& edge = scene.box.z_edge_m;
  const auto upper = std::upper_bound(edge.begin() + 1, edge.end() - 1, z);
  const std::size_t k = static_cast<std::size_t>(upper - edge.begin()) - 1;
  const double share = std::clamp((z - edge[k]) / (edge[k + 1] - edge[k]), 0., 1.);
  return (1 - share) * by_edge[k] + share * by_edge[k + 1];
}

/// Boundary at the end of the line.
template <class Real>
double beyond(const SightScene<Real>& scene, const CellWalk& walk, const Direction& travel) {
  const double lowest = scene.box.z_edge_m.front();
  switch (walk.place()) {
    case CellWalk::Place::below:
      return static_cast<double>(scene.ground.at(travel, walk.column()));
    case CellWalk::Place::beside:
      return beside(scene, walk.point(walk.entry()).z(), travel);
    // The line misses the domain.
    case CellWalk::Place::missed:
      return scene.box.periodic || travel.z() <= 0 ? scene.sky_radiance : beside(scene, lowest, travel);
    default:
      return scene.sky_radiance;
  }
}

}  // namespace sight

/// Radiance at `eye` along the unit vector `sight` of view, W m-2 sr-1 (docs/theory.md, Eq. 30).
/// @param source (cell) -> source of that cell towards the eye.
template <class Real, class Source>
double radiance_along(const SightScene<Real>& scene, const Eigen::Vector3d& eye, const Direction& sight,
                      const Source& source) {
  double transmitted = 1;
  double radiance = 0;
  const auto& linear = scene.cells_along(-sight);
  CellWalk walk(scene.box, eye, sight);
  for (; walk.is_inside(); walk.advance()) {
    const std::uint32_t cell = scene.cell_at[walk.cell()];
    if (cell == SightScene<Real>::no_cell || walk.exit() <= walk.entry()) continue;
    const Real extinction = linear.empty() ? scene.constant_extinction[cell] : linear[cell].extinction;
    const Crossing<Real> crossing(optical_path(extinction, static_cast<Real>(walk.exit() - walk.entry())));
    const Real emitted =
        crossing.t * (linear.empty() ? crossing.phi.phi1 : scene.emitted(crossing, linear[cell].gradient, walk));
    radiance += transmitted * static_cast<double>(emitted) * source(cell);
    transmitted -= transmitted * static_cast<double>(crossing.absorbed());
    if (transmitted < sight::seen_through) return radiance / (1 - transmitted);
  }
  return radiance + transmitted * sight::beyond(scene, walk, -sight);
}

}  // namespace cloudbow
