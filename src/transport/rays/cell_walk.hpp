// The cells of a box along a straight line, from wall to wall (after Amanatides and Woo 1987, Eurographics 87, 3-10).
// Geometry only.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "cloudbow/medium/optical_grid.hpp"
#include "cloudbow/sphere/control_points.hpp"

namespace cloudbow {

namespace sight {

/// Lines that are level never leave periodic air: they are followed through so many domains.
constexpr int most_domains = 2000;

/// Cuts the part [enter, leave] of a line, in distances along it. The rest lies between low and high on one axis.
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

/// Distances are in m from the eye. Walls belong to the cell that the line enters.
class CellWalk {
 public:
  /// Position of the walk. If it is not inside, it has ended or has not met the box at all. `endless`:
  /// sight::most_domains of periodic air are crossed.
  enum class Place { inside, missed, below, above, beside, endless };

  /// @param sight unit vector.
  CellWalk(const BoxGrid& box, const Eigen::Vector3d& eye, const Direction& sight);

  Place place() const { return place_; }
  bool is_inside() const { return place_ == Place::inside; }

  /// Index [(k*ny + j)*nx + i] of the cell.
  std::size_t cell() const { return (static_cast<std::size_t>(k_) * box_.ny + y_.index) * box_.nx + x_.index; }
  /// Index [j*nx + i] of the column; valid below the box too.
  std::size_t column() const { return static_cast<std::size_t>(y_.index) * box_.nx + x_.index; }
  /// Distance at which the line enters the cell, or left the box.
  double entry() const { return entry_; }
  /// Distance at which it leaves the cell. Not above entry() if it touches the cell at a corner only.
  double exit() const { return exit_; }
  Eigen::Vector3d point(double distance) const { return eye_ + distance * sight_; }
  /// That point in units of the cell, from the cell's centre.
  Eigen::Vector3d from_centre(double distance) const {
    const Eigen::Vector3d at = point(distance);
    return {(at.x() - box_.x_min_m) / box_.dx_m - x_.cell - .5, (at.y() - box_.y_min_m) / box_.dy_m - y_.cell - .5,
            (at.z() - box_.z_edge_m[k_]) / box_.thickness_m(k_) - .5};
  }

  /// Goes on to the next cell.
  void advance() {
    entry_ = std::max(entry_, exit_);
    if (exit_ == next_z_) {
      const bool was_uniform = crosses_uniform_level();
      step_vertically();
      if (was_uniform) find_column(point(entry_));
    } else if (exit_ == x_.next) {
      step(x_);
    } else {
      step(y_);
    }
    if (is_inside()) set_exit();
  }

 private:
  // A uniform level is crossed as one cell. Its column is not known before the line has left it.
  bool crosses_uniform_level() const { return sight_.z() != 0 && box_.is_uniform(k_); }
  void set_exit() { exit_ = crosses_uniform_level() ? next_z_ : std::min({x_.next, y_.next, next_z_}); }
  void find_column(const Eigen::Vector3d& start) {
    x_ = axis_at(start.x(), eye_.x(), sight_.x(), box_.x_min_m, box_.dx_m, box_.nx);
    y_ = axis_at(start.y(), eye_.y(), sight_.y(), box_.y_min_m, box_.dy_m, box_.ny);
  }

  // One horizontal axis.
  struct Axis {
    double eye;
    double along;  // of the unit vector; 0: no wall is crossed
    double low;
    double spacing;
    int n;
    double cell;  // counted on through periodic air
    int index;    // of the cell in the box
    double next;  // distance to the next wall
    double next_wall() const {
      return along == 0 ? never : (low + (cell + (along > 0 ? 1 : 0)) * spacing - eye) / along;
    }
  };
  static constexpr double never = std::numeric_limits<double>::infinity();

  Axis axis_at(double start, double eye, double along, double low, double spacing, int n) const {
    const double place = (start - low) / spacing;
    double cell = std::floor(place);
    if (cell == place && along < 0) --cell;
    if (!box_.periodic) cell = std::clamp(cell, 0., n - 1.);
    const double index = std::fmod(cell, n);
    const bool has_walls = !box_.periodic || n > 1;
    Axis axis{eye, has_walls ? along : 0, low, spacing, n, cell, static_cast<int>(index < 0 ? index + n : index), 0};
    axis.next = axis.next_wall();
    return axis;
  }

  double next_level_wall() const {
    return sight_.z() == 0 ? never : (box_.z_edge_m[k_ + (sight_.z() > 0 ? 1 : 0)] - eye_.z()) / sight_.z();
  }

  void step_vertically() {
    k_ += sight_.z() > 0 ? 1 : -1;
    if (k_ < 0) {
      place_ = Place::below;
    } else if (k_ == box_.nz()) {
      place_ = Place::above;
    } else {
      next_z_ = next_level_wall();
    }
  }

  void step(Axis& axis) {
    const int way = axis.along > 0 ? 1 : -1;
    axis.index += way;
    axis.cell += way;
    axis.next = axis.next_wall();
    if (axis.index >= 0 && axis.index < axis.n) return;
    axis.index = axis.index < 0 ? axis.n - 1 : 0;
    if (!box_.periodic) {
      place_ = Place::beside;
    } else if (++domains_ == sight::most_domains) {
      place_ = Place::endless;
    }
  }

  const BoxGrid& box_;
  Eigen::Vector3d eye_;
  Direction sight_;
  Place place_ = Place::inside;
  double entry_ = 0;
  double exit_ = 0;
  Axis x_{};
  Axis y_{};
  int k_ = 0;
  double next_z_ = 0;
  int domains_ = 0;
};

inline CellWalk::CellWalk(const BoxGrid& box, const Eigen::Vector3d& eye, const Direction& sight)
    : box_(box), eye_(eye), sight_(sight) {
  double leave = never;
  sight::clip(eye.z(), sight.z(), box.z_edge_m.front(), box.z_edge_m.back(), entry_, leave);
  if (!box.periodic) {
    sight::clip(eye.x(), sight.x(), box.x_min_m, box.x_min_m + box.nx * box.dx_m, entry_, leave);
    sight::clip(eye.y(), sight.y(), box.y_min_m, box.y_min_m + box.ny * box.dy_m, entry_, leave);
  }
  if (leave <= entry_) {
    place_ = Place::missed;
    return;
  }
  const Eigen::Vector3d start = point(entry_);
  find_column(start);
  const auto above = std::upper_bound(box.z_edge_m.begin() + 1, box.z_edge_m.end() - 1, start.z());
  k_ = static_cast<int>(above - box.z_edge_m.begin()) - 1;
  if (sight.z() < 0 && k_ > 0 && start.z() == box.z_edge_m[k_]) --k_;
  next_z_ = next_level_wall();
  set_exit();
}

}  // namespace cloudbow
