// Control points: the vertices of a subdivided icosahedron, on which spherical functions are stored, and the
// spherical-triangle weights that interpolate between them (Chatelier & Malgouyres, "A fast interpolation method to
// represent the BRDF in global illumination").
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>
#include <vector>

#include "cloudbow/sphere/direction.hpp"
#include "cloudbow/sphere/icosphere.hpp"

namespace cloudbow {

/// A function given at the control points has the value sum_i weight[i] * value[index[i]]; weights are >= 0 and sum
/// to 1.
struct Stencil {
  std::array<int, 3> index;
  std::array<double, 3> weight;
};

class ControlPoints {
 public:
  /// @param count 12, 42, 162 or 642 (icosahedron subdivided 0 to 3 times); anything else throws InputError.
  /// @param rotation turns the whole frame: points are rotation * (textbook icosphere).
  explicit ControlPoints(int count, const Eigen::Matrix3d& rotation = Eigen::Matrix3d::Identity());

  int size() const { return static_cast<int>(directions_.size()); }
  std::span<const Direction> directions() const { return directions_; }
  /// Vertex indices, counter-clockwise seen from outside.
  std::span<const std::array<int, 3>> triangles() const { return sphere_.triangle; }
  const Eigen::Matrix3d& rotation() const { return rotation_; }

  /// Triangle that contains the direction (found by parallels and meridians, confirmed by the cross-product test) and
  /// its weights: areas of the spherical triangles opposite each vertex, normalised to sum 1. Never fails. Exact at
  /// the vertices; on a side the weights that its two triangles give differ a little (under .003 with 162 points).
  Stencil stencil(const Direction& direction) const;

 private:
  int bin(double polar_angle, double azimuth) const;
  void fill_bins();
  const std::vector<int>& triangles_near(const Direction& local) const;

  Icosphere sphere_;  // in its own frame, where points are located
  std::vector<Direction> directions_;
  Eigen::Matrix3d rotation_;
  // Bins of the sphere by parallel (polar angle) and meridian (azimuth), each with the triangles that may touch it.
  int parallels_ = 0;
  int meridians_ = 0;
  std::vector<std::vector<int>> bins_;
};

/// Area of the spherical triangle a, b, c (unit vectors), positive where they run counter-clockwise seen from outside:
/// one arc tangent, accurate for slivers too (Van Oosterom & Strackee 1983, Eq. 8).
double spherical_triangle_area(const Direction& a, const Direction& b, const Direction& c);

}  // namespace cloudbow
