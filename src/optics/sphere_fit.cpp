#include "cloudbow/optics/sphere_fit.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <cassert>
#include <utility>

#include "cloudbow/core/error.hpp"
#include "fit_programme.hpp"
#include "interior_point.hpp"

namespace cloudbow {
namespace {

constexpr double row_tolerance = 1e-6;    // a solution of a linear programme is rejected if a row is off by more
constexpr double bound_tolerance = 1e-6;  // or a value is below its bound by more
constexpr double least_scale = 1e-6;      // of the largest

}  // namespace

Eigen::VectorXd residual_scale(const Eigen::VectorXd& value, ResidualScale scale) {
  if (scale == ResidualScale::absolute) return Eigen::VectorXd::Ones(value.size());
  const double largest = value.cwiseAbs().maxCoeff();
  if (largest == 0) return Eigen::VectorXd::Ones(value.size());
  const Eigen::VectorXd size = value.cwiseAbs().cwiseMax(least_scale * largest);
  return scale == ResidualScale::relative ? size : Eigen::VectorXd(size.cwiseSqrt());
}

Eigen::VectorXd corrected(const ExactRows& rows, Eigen::VectorXd x) {
  x /= rows.matrix.row(0).dot(x);
  const Eigen::VectorXd size = x.cwiseAbs();
  const Eigen::MatrixXd system = rows.matrix * size.asDiagonal() * rows.matrix.transpose();
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(1e-12);
  solver.compute(system);
  const Eigen::VectorXd lambda = solver.solve(rows.right - rows.matrix * x);
  return x + size.cwiseProduct(rows.matrix.transpose() * lambda);
}

SphereFit::SphereFit(const ControlPoints& points, std::vector<Direction> samples)
    : points_(points.size()), sample_(std::move(samples)) {
  for (const Direction& v : sample_) stencil_.push_back(points.stencil(v));
  pattern_ = NormalPattern(stencil_, points_);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(points.size(), points.size());
  for (const Stencil& s : stencil_) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) normal(s.index[i], s.index[j]) += s.weight[i] * s.weight[j];
    }
  }
  normal_equations_.compute(normal);
  if (normal_equations_.info() != Eigen::Success) {
    throw InputError(
        fmt::format("fit: {} samples do not determine the values at {} control points (some four times as "
                    "many samples, spread evenly, do)",
                    sample_.size(), points_));
  }
}

Eigen::VectorXd SphereFit::interpolated(const Eigen::VectorXd& at_points) const {
  Eigen::VectorXd value(stencil_.size());
  for (std::size_t i = 0; i < stencil_.size(); ++i) {
    const auto& [index, weight] = stencil_[i];
    value[i] = weight[0] * at_points[index[0]] + weight[1] * at_points[index[1]] + weight[2] * at_points[index[2]];
  }
  return value;
}

Eigen::VectorXd SphereFit::least_squares(const Eigen::VectorXd& value) const {
  Eigen::VectorXd right = Eigen::VectorXd::Zero(points_);
  for (std::size_t i = 0; i < stencil_.size(); ++i) {
    for (int k = 0; k < 3; ++k) right[stencil_[i].index[k]] += stencil_[i].weight[k] * value[i];
  }
  return normal_equations_.solve(right);
}

std::optional<Eigen::VectorXd> SphereFit::minimax(const Eigen::VectorXd& value, ResidualScale scale) const {
  FitProgramme programme;
  programme.samples = stencil_;
  programme.value = value;
  programme.scale = residual_scale(value, scale);
  programme.mean_weight = 0;
  programme.rows.resize(0, points_);
  programme.lower.reset();
  for (const Simplex algorithm : {Simplex::primal, Simplex::dual}) {
    const auto x = solve(programme, algorithm);
    if (x && x->allFinite()) return x;
  }
  return std::nullopt;
}

std::optional<Eigen::VectorXd> SphereFit::constrained(const Eigen::VectorXd& value, ConstrainedFit fit,
                                                      int& linear_programmes) const {
  assert(fit.scale.size() == value.size() && value.size() == static_cast<Eigen::Index>(stencil_.size()));
  FitProgramme programme;
  programme.samples = stencil_;
  programme.value = value;
  programme.scale = std::move(fit.scale);
  programme.mean_scale = std::move(fit.mean_scale);
  programme.mean_weight = fit.mean_weight;
  programme.largest = fit.bound     ? LargestResidual::bounded
                      : fit.minimax ? LargestResidual::minimised
                                    : LargestResidual::free;
  programme.bound = fit.bound.value_or(0);
  programme.lower = fit.lower;
  programme.rows = std::move(fit.rows.matrix);
  programme.right = std::move(fit.rows.right);
  const auto checked = [&](const std::optional<Eigen::VectorXd>& x) -> std::optional<Eigen::VectorXd> {
    ++linear_programmes;
    if (!x || !x->allFinite()) return std::nullopt;
    const double off = (programme.rows * *x - programme.right).cwiseAbs().maxCoeff();
    if (off > row_tolerance || x->minCoeff() < fit.lower - bound_tolerance) return std::nullopt;
    return x->cwiseMax(fit.lower);
  };
  // An interior point needs a mean error to weigh; what it does not solve, simplex methods decide.
  if (programme.mean_weight > 0) {
    if (auto x = checked(solve_by_interior_point(programme, pattern_))) return x;
  }
  for (const Simplex algorithm : {Simplex::primal, Simplex::dual}) {
    if (auto x = checked(solve(programme, algorithm))) return x;
  }
  return std::nullopt;
}

}  // namespace cloudbow
