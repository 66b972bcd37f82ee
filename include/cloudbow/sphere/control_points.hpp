// Control points: the vertices of a subdivided icosahedron (or other polyhedron), on which spherical functions are
// stored. Spherical-triangle weights interpolate between them. Source: Chatelier & Malgouyres, "A fast interpolation
// method to represent the BRDF in global illumination".
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>
#include <vector>

#include "cloudbow/sphere/direction.hpp"
#include "cloudbow/sphere/interpolation_weights.hpp"
#include "cloudbow/sphere/sphere_mesh.hpp"

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
  /// @param subdivisions 0 to 6; anything else throws InputError.
  ControlPoints(Polyhedron polyhedron, int subdivisions, const Eigen::Matrix3d& rotation = Eigen::Matrix3d::Identity());

  int size() const { return static_cast<int>(directions_.size()); }
  std::span<const Direction> directions() const { return directions_; }
  /// Vertex indices, counter-clockwise seen from outside.
  std::span<const std::array<int, 3>> triangles() const { return mesh_.triangle; }
  const Eigen::Matrix3d& rotation() const { return rotation_; }

  /// Index of the triangle that contains the direction, found by parallels and meridians and confirmed by the
  /// cross-product test. Never fails; on a side or vertex it is any of the triangles that share it.
  int triangle_at(const Direction& direction) const;

  /// The corners of the triangle that contains the direction and their weights (interpolation_weights.hpp). Exact at
  /// the vertices; with areas, the weights that two triangles give on their common side differ a little (under .003
  /// with 162 points).
  Stencil stencil(const Direction& direction, Interpolation interpolation = Interpolation::spherical_area) const;

 private:
  int bin(double polar_angle, double azimuth) const;
  void fill_bins();
  const std::vector<int>& triangles_near(const Direction& local) const;
  int triangle_at_local(const Direction& local) const;

  SphereMesh mesh_;  // in its own frame, in which points are located
  std::vector<Direction> directions_;
  std::vector<std::array<Direction, 3>> side_normal_;  // of each triangle, pointing inwards, in the mesh's frame
  Eigen::Matrix3d rotation_;
  // Bins of the sphere by parallel (polar angle) and meridian (azimuth), each with the triangles that may touch it.
  int parallels_ = 0;
  int meridians_ = 0;
  std::vector<std::vector<int>> bins_;
};

}  // namespace cloudbow
