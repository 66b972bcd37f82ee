#include "cloudbow/sphere/control_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

constexpr double pi = std::numbers::pi;

int subdivisions_for(int count) {
  for (int subdivisions = 0; subdivisions <= 3; ++subdivisions) {
    if (count == 10 * (1 << (2 * subdivisions)) + 2) return subdivisions;
  }
  throw InputError(fmt::format("control points: there is no set of {} (allowed: 12, 42, 162 or 642)", count));
}

int checked_subdivisions(int subdivisions) {
  if (subdivisions < 0 || subdivisions > 6) {
    throw InputError(
        fmt::format("control points: a polyhedron cannot be subdivided {} times (allowed: 0 to 6)", subdivisions));
  }
  return subdivisions;
}

}  // namespace

ControlPoints::ControlPoints(int count, const Eigen::Matrix3d& rotation)
    : ControlPoints(Polyhedron::icosahedron, subdivisions_for(count), rotation) {}

ControlPoints::ControlPoints(Polyhedron polyhedron, int subdivisions, const Eigen::Matrix3d& rotation)
    : mesh_(make_sphere_mesh(polyhedron, checked_subdivisions(subdivisions))), rotation_(rotation) {
  const auto& v = mesh_.vertex;
  for (const Direction& local : v) directions_.push_back(rotation_ * local);
  for (const auto& [a, b, c] : mesh_.triangle) {
    side_normal_.push_back({v[a].cross(v[b]), v[b].cross(v[c]), v[c].cross(v[a])});
  }
  fill_bins();
}

int ControlPoints::bin(double polar_angle, double azimuth) const {
  const int row = std::clamp(static_cast<int>(polar_angle / pi * parallels_), 0, parallels_ - 1);
  const int column = static_cast<int>(std::floor((azimuth / (2 * pi) + 1) * meridians_)) % meridians_;
  return row * meridians_ + column;
}

// A triangle is entered into all bins that its circumscribed cap may touch. That takes little time, and every point
// finds its triangle.
void ControlPoints::fill_bins() {
  parallels_ = static_cast<int>(2 * std::sqrt(size()));
  meridians_ = 2 * parallels_;
  bins_.resize(parallels_ * meridians_);
  const double row_height = pi / parallels_, column_width = pi / parallels_;
  for (int t = 0; t < static_cast<int>(mesh_.triangle.size()); ++t) {
    const auto& [a, b, c] = mesh_.triangle[t];
    const auto& v = mesh_.vertex;
    const Direction centre = (v[a] + v[b] + v[c]).normalized();
    constexpr double margin = 1e-6;  // far above rounding, far below a bin
    const double radius = margin + std::acos(std::min({centre.dot(v[a]), centre.dot(v[b]), centre.dot(v[c])}));
    const double polar_angle = std::acos(centre.z()), azimuth = std::atan2(centre.y(), centre.x());
    const bool holds_pole = polar_angle < radius || polar_angle > pi - radius;
    const double reach = holds_pole ? pi : std::asin(std::sin(radius) / std::sin(polar_angle));

    const int first_row = std::max(0, static_cast<int>(std::floor((polar_angle - radius) / row_height)));
    const int last_row = std::min(parallels_ - 1, static_cast<int>(std::floor((polar_angle + radius) / row_height)));
    const int first_column = static_cast<int>(std::floor((azimuth - reach) / column_width));
    const int last_column =
        std::min(first_column + meridians_ - 1, static_cast<int>(std::floor((azimuth + reach) / column_width)));
    for (int row = first_row; row <= last_row; ++row) {
      for (int column = first_column; column <= last_column; ++column) {
        bins_[row * meridians_ + (column + 2 * meridians_) % meridians_].push_back(t);
      }
    }
  }
}

const std::vector<int>& ControlPoints::triangles_near(const Direction& local) const {
  return bins_[bin(std::acos(std::clamp(local.z(), -1.0, 1.0)), std::atan2(local.y(), local.x()))];
}

int ControlPoints::triangle_at_local(const Direction& local) const {
  // A point lies inside a triangle if it is to the left of all three sides. On a side, rounding can exclude it from
  // both neighbours. So the triangle that comes nearest to containing the point is taken, and there is always one.
  int nearest = -1;
  double inside = -std::numeric_limits<double>::infinity();
  for (const int t : triangles_near(local)) {
    const auto& [ab, bc, ca] = side_normal_[t];
    const double least = std::min({local.dot(ab), local.dot(bc), local.dot(ca)});
    if (least > inside) {
      inside = least;
      nearest = t;
      constexpr double rounding = 1e-12;
      if (inside > rounding) break;  // no other can hold it as well
    }
  }
  return nearest;
}

int ControlPoints::triangle_at(const Direction& direction) const {
  return triangle_at_local((rotation_.transpose() * direction).normalized());
}

Stencil ControlPoints::stencil(const Direction& direction, Interpolation interpolation) const {
  const Direction p = (rotation_.transpose() * direction).normalized();
  const auto& corner = mesh_.triangle[triangle_at_local(p)];
  const Direction &a = mesh_.vertex[corner[0]], &b = mesh_.vertex[corner[1]], &c = mesh_.vertex[corner[2]];
  return {corner,
          interpolation == Interpolation::planar ? planar_weights(p, a, b, c) : spherical_area_weights(p, a, b, c)};
}

}  // namespace cloudbow
