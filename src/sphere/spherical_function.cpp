#include "cloudbow/sphere/spherical_function.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

template <class Real>
void query_block(const Stencil& stencil, const Real* values, std::size_t functions, std::size_t first,
                 std::size_t count, Real* result) {
  const Real* a = values + stencil.index[0] * functions + first;
  const Real* b = values + stencil.index[1] * functions + first;
  const Real* c = values + stencil.index[2] * functions + first;
  const Real wa = static_cast<Real>(stencil.weight[0]), wb = static_cast<Real>(stencil.weight[1]),
             wc = static_cast<Real>(stencil.weight[2]);
  for (std::size_t n = 0; n < count; ++n) result[n] = wa * a[n] + wb * b[n] + wc * c[n];
}

double angle_between(const Direction& a, const Direction& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

}  // namespace

template <class Real>
void query(const Stencil& stencil, std::span<const Real> values, std::span<Real> result) {
  assert(values.size() % result.size() == 0);
  query_block(stencil, values.data(), result.size(), 0, result.size(), result.data());
}

template <class Real>
void query(std::span<const Stencil> stencils, std::size_t functions, std::span<const Real> values,
           std::span<Real> result) {
  assert(values.size() % functions == 0 && result.size() == stencils.size() * functions);
  constexpr std::size_t block = 1024;  // 162 points x 1024 x 4 bytes = 650 b: second-level cache
  for (std::size_t first = 0; first < functions; first += block) {
    const std::size_t count = std::min(block, functions - first);
    for (std::size_t d = 0; d < stencils.size(); ++d) {
      query_block(stencils[d], values.data(), functions, first, count, result.data() + d * functions + first);
    }
  }
}

template <class Real>
void add_scaled(Real factor, std::span<const Real> values, std::span<Real> sum) {
  assert(values.size() == sum.size());
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += factor * values[i];
}

template void query(const Stencil&, std::span<const float>, std::span<float>);
template void query(const Stencil&, std::span<const double>, std::span<double>);
template void query(std::span<const Stencil>, std::size_t, std::span<const float>, std::span<float>);
template void query(std::span<const Stencil>, std::size_t, std::span<const double>, std::span<double>);
template void add_scaled(float, std::span<const float>, std::span<float>);
template void add_scaled(double, std::span<const double>, std::span<double>);

std::vector<double> deformation_lobe(const ControlPoints& points, const Direction& centre, double reach) {
  const Stencil stencil = points.stencil(centre);
  const auto corner = [&](int k) { return points.directions()[stencil.index[k]]; };
  const double longest_side = std::max(
      {angle_between(corner(0), corner(1)), angle_between(corner(1), corner(2)), angle_between(corner(2), corner(0))});
  if (!(reach >= longest_side && reach <= std::numbers::pi)) {
    throw InputError(fmt::format(
        "deformation: its reach is {} rad (allowed: {:.4g}, the triangle's longest side, to pi)", reach, longest_side));
  }
  std::vector<double> lobe;
  for (const Direction& v : points.directions()) {
    const double x = angle_between(v, centre) / reach;
    lobe.push_back(x < 1 ? (1 - x * x) * (1 - x * x) : 0);
  }
  double at_centre = 0;
  for (int k = 0; k < 3; ++k) at_centre += stencil.weight[k] * lobe[stencil.index[k]];
  for (double& value : lobe) value /= at_centre;
  return lobe;
}

SphericalFunction::SphericalFunction(std::shared_ptr<const ControlPoints> points, std::vector<double> values)
    : points_(std::move(points)), values_(std::move(values)) {
  assert(points_ && static_cast<int>(values_.size()) == points_->size());
}

SphericalFunction::SphericalFunction(std::shared_ptr<const ControlPoints> points,
                                     const std::function<double(const Direction&)>& f)
    : points_(std::move(points)) {
  assert(points_);
  for (const Direction& v : points_->directions()) values_.push_back(f(v));
}

double SphericalFunction::operator()(const Direction& direction) const {
  double value = 0;
  query<double>(points_->stencil(direction), values_, std::span(&value, 1));
  return value;
}

std::vector<double> SphericalFunction::operator()(std::span<const Direction> directions) const {
  std::vector<double> result;
  for (const Direction& d : directions) result.push_back((*this)(d));
  return result;
}

SphericalFunction& SphericalFunction::operator*=(double factor) {
  for (double& value : values_) value *= factor;
  return *this;
}

SphericalFunction& SphericalFunction::operator+=(const SphericalFunction& other) {
  assert(points_ == other.points_);
  add_scaled<double>(1, other.values_, values_);
  return *this;
}

void SphericalFunction::deform(const Direction& centre, double value, double reach) {
  const double change = value - (*this)(centre);
  add_scaled<double>(change, deformation_lobe(*points_, centre, reach), values_);
}

void SphericalFunction::move_value_at(const Direction& direction, double change) {
  const auto [index, weight] = points_->stencil(direction);
  const double squares = weight[0] * weight[0] + weight[1] * weight[1] + weight[2] * weight[2];
  for (std::size_t k = 0; k < 3; ++k) values_[static_cast<std::size_t>(index[k])] += weight[k] * change / squares;
}

}  // namespace cloudbow
