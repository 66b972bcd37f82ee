// Functions on the sphere, given by their values at control points: query, scale, add and deform. (rotation.hpp turns
// them.) The free functions work on many functions at once: `values` then holds M rows, one per control point, of N
// contiguous functions. The stencil of a query, which depends on its direction alone, is computed once for all of them.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "cloudbow/sphere/control_points.hpp"

namespace cloudbow {

/// result[n] = function n in the stencil's direction: 3 products each. Real is float or double.
template <class Real>
void query(const Stencil& stencil, std::span<const Real> values, std::span<Real> result);

/// The same in D directions: result holds D rows of N. Works through the functions by blocks that stay in cache.
/// @param functions N; values has M * N elements, result D * N.
template <class Real>
void query(std::span<const Stencil> stencils, std::size_t functions, std::span<const Real> values,
           std::span<Real> result);

/// sum += factor * values: scales and adds all functions at once, whatever they are represented by.
template <class Real>
void add_scaled(Real factor, std::span<const Real> values, std::span<Real> sum);

/// The lobe of a deformation (theory.md, Eq. 9a): values (1 - (angle/reach)^2)^2 at control points nearer to `centre`
/// than `reach`, 0 beyond. They are divided by their interpolant at the centre, so that the lobe is 1 there.
/// @param reach [rad], up to pi and not below the longest side of the triangle with the centre; otherwise throws
/// InputError.
std::vector<double> deformation_lobe(const ControlPoints& points, const Direction& centre, double reach);

class SphericalFunction {
 public:
  /// @param values one for each control point.
  SphericalFunction(std::shared_ptr<const ControlPoints> points, std::vector<double> values);
  /// Takes the values of f at the control points.
  SphericalFunction(std::shared_ptr<const ControlPoints> points, const std::function<double(const Direction&)>& f);

  const ControlPoints& points() const { return *points_; }
  std::span<const double> values() const { return values_; }

  double operator()(const Direction& direction) const;
  std::vector<double> operator()(std::span<const Direction> directions) const;

  SphericalFunction& operator*=(double factor);
  /// @param other on the same ControlPoints object.
  SphericalFunction& operator+=(const SphericalFunction& other);

  /// Moves the value at `centre` to `value`: adds (value - old value) * deformation_lobe(centre, reach). Values around
  /// move too, less and less with the angle up to `reach` [rad], beyond which nothing changes. Raising keeps a positive
  /// function positive. Lowering may make it negative at directions in which it was below its value at the centre.
  void deform(const Direction& centre, double value, double reach);

  /// Moves the value at `direction` by `change`: each of the three control points around it moves by w_i change /
  /// (w_1^2 + w_2^2 + w_3^2). w_i is its weight there (theory.md, Eq. 9c; Chatelier & Malgouyres 2007, Eq. 8). Of all
  /// changes of control points that do this, it is the smallest in the sense of least squares.
  void move_value_at(const Direction& direction, double change);

  /// The same control points with other values, such as permute() and reweight() return.
  SphericalFunction with_values(std::vector<double> values) const { return {points_, std::move(values)}; }

 private:
  std::shared_ptr<const ControlPoints> points_;
  std::vector<double> values_;
};

}  // namespace cloudbow
