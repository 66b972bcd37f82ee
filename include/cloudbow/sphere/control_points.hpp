// Control points: the vertices of a subdivided icosahedron, on which spherical functions are stored, and the spherical-triangle weights
// that interpolate between them (Chatelier & Malgouyres, "A fast interpolation method to represent the BRDF in global illumination").
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>
#include <vector>

namespace cloudbow {

/// Unit vector. In transport it is the direction of travel of light, z up.
using Direction = Eigen::Vector3d;

/// A function given at the control points has the value sum_i weight[i] * value[index[i]]; weights are >= 0 and sum to 1.
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
  std::span<const std::array<int, 3>> triangles() const { return triangles_; }
  const Eigen::Matrix3d& rotation() const { return rotation_; }

  /// Triangle that contains the direction (found by parallels and meridians, confirmed by the cross-product test) and its
  /// weights: areas of the spherical triangles opposite each vertex, normalised to sum 1.
  Stencil stencil(const Direction& direction) const;

 private:
  std::vector<Direction> directions_;
  std::vector<std::array<int, 3>> triangles_;
  Eigen::Matrix3d rotation_;
  // Bins of the sphere by parallel (z) and meridian (azimuth), each with the triangles that touch it.
  int parallels_ = 0;
  int meridians_ = 0;
  std::vector<std::vector<int>> bins_;
};

}  // namespace cloudbow
