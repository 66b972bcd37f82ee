// Ordinate sets: the discrete directions of travel and their quadrature weights.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cloudbow/sphere/control_points.hpp"

namespace cloudbow {

struct OrdinateSet {
  std::string name;
  std::vector<Direction> direction;  ///< D unit vectors, none with z = 0; those with z < 0 (downward) first.
  std::vector<double> weight;        ///< D quadrature weights [sr], positive, sum 4 pi.
  int exactness_degree =
      0;  ///< Spherical harmonics up to this degree are integrated exactly (to 1e-10; at most 64 is reported).
  /// Orthogonal maps of the set onto itself: reflections of an octant, or the icosahedral group in the set's own frame.
  std::vector<Eigen::Matrix3d> symmetry;
  bool is_control_points = false;

  int size() const { return static_cast<int>(direction.size()); }
};

/// Names: "double-gauss-NxK" (N polar angles over the sphere, even, 2 to 64; K azimuths, a multiple of 4, 4 to 128;
/// e.g. "double-gauss-8x16"),
/// "reduced-double-gauss-NxK" (fewer azimuths near the poles, e.g. "reduced-double-gauss-12x20"),
/// "control-points-M" (the turned icosphere, M = 42, 162 or 642, orbit weights). Throws InputError listing what is
/// allowed.
OrdinateSet make_ordinate_set(std::string_view name);

/// Quadrature weights [sr] of the icosphere's vertices, sum 4 pi, equal on each orbit of the icosahedral group, all
/// positive: exact for spherical harmonics to degree 5, 9, 15 and 27 with 12, 42, 162 and 642 vertices.
/// @param subdivisions 0 to 3.
std::vector<double> icosphere_weights(int subdivisions);

/// Rotation that ordinates and control points share when the ordinates are control points: quaternion (x,y,z,w) =
/// (.1056,.9465,.2242,.2067).
Eigen::Matrix3d control_point_frame_rotation();

}  // namespace cloudbow
