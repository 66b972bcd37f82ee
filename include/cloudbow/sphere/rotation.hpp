// Rotation of functions that are given at control points. The rotated function takes in direction R v the value that
// the function had in direction v. There are two ways. A permutation of the control points keeps every value, and so
// the peak. It displaces the peak by up to half the spacing of the points. Interpolation of the values flattens peaks a
// little each time. Both are prepared once for a rotation and a set of points. They are then applied to any number of
// functions, whose values are M rows of N contiguous functions.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "cloudbow/sphere/control_points.hpp"

namespace cloudbow {

/// The value at point m becomes the one that was at point source[m]; every point is the source of one other.
using PointPermutation = std::vector<int>;

/// The permutation that the rotation is, if it maps the set of points onto itself (to 1e-9 rad); empty otherwise. The
/// 60 rotations of the icosahedral group (in the points' own frame) do. Reflections may be given as well.
std::optional<PointPermutation> exact_permutation(const ControlPoints& points, const Eigen::Matrix3d& rotation);

/// Methods that match rotated points to points, one to one. All find the exact permutation if there is one. The first
/// two are quick (M^2 log M and M^2). The partners that they leave for the last points may be far away. The third is
/// M^3.
enum class Matching {
  best_first,    ///< Of all pairs left, always the closest.
  outward,       ///< From the closest pair outward through neighbours, each rotated point to the closest free point.
  least_squares  ///< The least sum of squared distances (assignment problem, solved by shortest augmenting paths).
};

PointPermutation nearest_permutation(const ControlPoints& points, const Eigen::Matrix3d& rotation, Matching matching);

/// For each control point v the stencil of the direction R^T v: the rotation by interpolation.
std::vector<Stencil> reweighting(const ControlPoints& points, const Eigen::Matrix3d& rotation,
                                 Interpolation interpolation = Interpolation::spherical_area);

/// Rows of `rotated` are rows of `values`, without arithmetic. The two must not overlap. Real is float or double.
template <class Real>
void permute(const PointPermutation& source, std::span<const Real> values, std::span<Real> rotated);

/// Rows of `rotated` are weighted sums of three rows of `values`. The two must not overlap.
template <class Real>
void reweight(std::span<const Stencil> stencils, std::span<const Real> values, std::span<Real> rotated);

}  // namespace cloudbow
