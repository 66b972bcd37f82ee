#include "column_fit.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "cloudbow/sphere/icosphere.hpp"
#include "cloudbow/sphere/spherical_harmonics.hpp"
#include "fit_programme.hpp"

namespace cloudbow {
namespace {

constexpr double four_pi = 4 * std::numbers::pi;
constexpr double tiny = 1e-12;            // an entry below stands for 0, see FitProgramme
constexpr double row_tolerance = 1e-6;    // a solution of a linear programme is rejected if a row is off by more
constexpr double bound_tolerance = 1e-6;  // or a value is below its bound by more

/// h_l = int_0^1 mu^power P_l dmu, l < count: from h_l = (P_{l-1}(0) - P_{l+1}(0)) / (2l+1) for power 0, raised by
/// (2l+1) mu P_l = (l+1) P_{l+1} + l P_{l-1}.
std::vector<double> half_range_integrals(int count, int power) {
  const int n = count + power;
  std::vector<double> at_zero(n + 2, 0.0);
  at_zero[0] = 1;
  for (int l = 2; l < n + 2; l += 2) at_zero[l] = -at_zero[l - 2] * (l - 1) / l;
  std::vector<double> h(n);
  h[0] = 1;
  for (int l = 1; l < n; ++l) h[l] = (at_zero[l - 1] - at_zero[l + 1]) / (2 * l + 1);
  for (int p = 0; p < power; ++p) {
    std::vector<double> raised(h.size() - 1);
    raised[0] = h[1];
    for (int l = 1; l < static_cast<int>(raised.size()); ++l)
      raised[l] = ((l + 1) * h[l + 1] + l * h[l - 1]) / (2 * l + 1);
    h = std::move(raised);
  }
  return h;
}

/// (1/4pi) int_up mu^power P(O . v) dO for a direction v with z component z, as a Legendre series: exact however sharp
/// the peak.
double half_range_moment(const PhaseFunction& phase, double z, int power) {
  const auto chi = phase.moments();
  const std::vector<double> h = half_range_integrals(static_cast<int>(chi.size()), power);
  double sum = 0, legendre = 1, next = z;
  for (int l = 0; l < static_cast<int>(chi.size()); ++l) {
    sum += (2 * l + 1) * chi[l] * legendre * h[l];
    legendre = std::exchange(next, ((2 * l + 3) * z * next - (l + 1) * legendre) / (l + 2));
  }
  return sum / 2;
}

/// The functionals' rows on the control points: each ordinate's share goes to the three points that it is interpolated
/// from.
Eigen::MatrixXd on_points(const Eigen::MatrixXd& on_ordinates, const std::vector<Stencil>& stencil, int points) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(on_ordinates.rows(), points);
  for (std::size_t d = 0; d < stencil.size(); ++d) {
    for (int k = 0; k < 3; ++k) rows.col(stencil[d].index[k]) += stencil[d].weight[k] * on_ordinates.col(d);
  }
  return rows.unaryExpr([](double c) { return std::abs(c) < tiny ? 0.0 : c; });
}

double least_value(const PhaseFunction& phase) {
  constexpr int steps = 4000;
  double least = phase(1);
  for (int i = 1; i <= steps; ++i) least = std::min(least, phase(std::cos(std::numbers::pi * i / steps)));
  return least;
}

/// The smallest relative change that makes the rows exact: X += |X| C^T lambda with (C diag|X| C^T) lambda = right - C
/// X.
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

/// Solves the programme with these rows; false where there is no solution or none that stands up to checking.
bool fit_with_rows(FittedColumn& column, FitProgramme& programme, ExactRows rows) {
  programme.rows = std::move(rows.matrix);
  programme.right = std::move(rows.right);
  for (const Simplex algorithm : {Simplex::primal, Simplex::dual}) {
    ++column.linear_programmes;
    const auto x = solve(programme, algorithm);
    if (!x || !x->allFinite()) continue;
    const double off = (programme.rows * *x - programme.right).cwiseAbs().maxCoeff();
    if (off > row_tolerance || x->minCoeff() < programme.lower - bound_tolerance) continue;
    column.value = x->cwiseMax(programme.lower);
    return true;
  }
  return false;
}

}  // namespace

ColumnFit::ColumnFit(const ControlPoints& points, const OrdinateSet& ordinates, const FitOptions& options)
    : points_(points), options_(options) {
  const Icosphere fine = make_icosphere(points.size() > 162 ? 4 : 3);
  for (const Direction& v : fine.vertex) {
    sample_.push_back(points.rotation() * v);
    sample_stencil_.push_back(points.stencil(sample_.back()));
  }

  std::vector<Stencil> stencil;
  std::vector<Direction> local;  // in the frame of the control points many entries of the rows vanish by symmetry
  for (const Direction& v : ordinates.direction) {
    stencil.push_back(points.stencil(v));
    local.push_back(points.rotation().transpose() * v);
  }
  const Eigen::Map<const Eigen::VectorXd> weight(ordinates.weight.data(), ordinates.size());
  const Eigen::MatrixXd harmonics = real_spherical_harmonics(local, options.exact_moments);
  moment_rows_ = on_points(harmonics * weight.asDiagonal() / std::sqrt(four_pi), stencil, points.size());
  Eigen::MatrixXd upward(options.beam_half_range_rows, ordinates.size());
  for (int d = 0; d < ordinates.size(); ++d) {
    const double mu = ordinates.direction[d].z();
    for (int k = 0; k < upward.rows(); ++k) upward(k, d) = mu > 0 ? weight[d] / four_pi * std::pow(mu, k) : 0;
  }
  half_range_rows_ = on_points(upward, stencil, points.size());

  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(points.size(), points.size());
  for (const Stencil& s : sample_stencil_) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) normal(s.index[i], s.index[j]) += s.weight[i] * s.weight[j];
    }
  }
  normal_equations_.compute(normal);
}

ExactRows ColumnFit::exact_rows(const PhaseFunction& phase, const Direction& travel, int degree,
                                int half_range_rows) const {
  const int moments = (degree + 1) * (degree + 1);
  ExactRows rows{Eigen::MatrixXd(moments + half_range_rows, points_.size()),
                 Eigen::VectorXd(moments + half_range_rows)};
  rows.matrix << moment_rows_.topRows(moments), half_range_rows_.topRows(half_range_rows);
  const Direction local = points_.rotation().transpose() * travel;
  const Eigen::VectorXd harmonics = real_spherical_harmonics(std::span(&local, 1), degree);
  for (int l = 0; l <= degree; ++l) {
    const auto first = harmonic_index(l, -l), count = 2 * l + 1;
    rows.right.segment(first, count) = std::sqrt(four_pi) * phase.moment(l) * harmonics.segment(first, count);
  }
  for (int k = 0; k < half_range_rows; ++k) rows.right[moments + k] = half_range_moment(phase, travel.z(), k);
  rows.right = rows.right.unaryExpr([](double c) { return std::abs(c) < tiny ? 0.0 : c; });
  return rows;
}

Eigen::VectorXd ColumnFit::sampled(const PhaseFunction& phase, const Direction& travel) const {
  Eigen::VectorXd value(sample_.size());
  for (std::size_t i = 0; i < sample_.size(); ++i) value[i] = phase(sample_[i].dot(travel));
  return value;
}

Eigen::VectorXd ColumnFit::at_points(const PhaseFunction& phase, const Direction& travel) const {
  Eigen::VectorXd value(points_.size());
  for (int m = 0; m < points_.size(); ++m) value[m] = phase(points_.directions()[m].dot(travel));
  return value;
}

Eigen::VectorXd ColumnFit::interpolated(const Eigen::VectorXd& column) const {
  Eigen::VectorXd value(sample_.size());
  for (std::size_t i = 0; i < sample_.size(); ++i) {
    const auto& [index, weight] = sample_stencil_[i];
    value[i] = weight[0] * column[index[0]] + weight[1] * column[index[1]] + weight[2] * column[index[2]];
  }
  return value;
}

Eigen::VectorXd ColumnFit::least_squares(const Eigen::VectorXd& value) const {
  Eigen::VectorXd right = Eigen::VectorXd::Zero(points_.size());
  for (std::size_t i = 0; i < sample_.size(); ++i) {
    for (int k = 0; k < 3; ++k) right[sample_stencil_[i].index[k]] += sample_stencil_[i].weight[k] * value[i];
  }
  return normal_equations_.solve(right);
}

void ColumnFit::fit_by_programme(FittedColumn& column, const PhaseFunction& phase, const Direction& travel,
                                 int half_range_rows) const {
  FitProgramme programme;
  programme.samples = sample_stencil_;
  programme.value = sampled(phase, travel);
  programme.scale = programme.value.cwiseAbs().cwiseMax(0.05).cwiseSqrt();
  programme.minimax = options_.minimax;
  programme.lower = std::min(0.0, least_value(phase));

  // What is asked for may have no solution that is positive (a coarse set of points, a strong peak): then fewer
  // moments, then fewer half-range rows. The integral alone can always be held.
  for (int half_range = half_range_rows; half_range >= 0; --half_range) {
    for (int degree = options_.exact_moments; degree >= (half_range > 0 ? std::min(1, options_.exact_moments) : 0);
         --degree) {
      if (fit_with_rows(column, programme, exact_rows(phase, travel, degree, half_range))) return;
      column.fell_back = true;
    }
  }
  const ExactRows rows = exact_rows(phase, travel, std::min(3, options_.exact_moments), 0);
  column.value = corrected(rows, least_squares(programme.value));
}

FittedColumn ColumnFit::fit(const PhaseFunction& phase, const Direction& travel, int half_range_rows) const {
  FittedColumn column;
  if (phase.is_isotropic()) {
    column.value = Eigen::VectorXd::Ones(points_.size());
  } else if (options_.method == FitMethod::linear_programming) {
    fit_by_programme(column, phase, travel, half_range_rows);
  } else {
    const bool collocated = options_.method == FitMethod::collocation;
    const Eigen::VectorXd plain = collocated ? at_points(phase, travel) : least_squares(sampled(phase, travel));
    column.value = corrected(exact_rows(phase, travel, options_.exact_moments, half_range_rows), plain);
  }
  // Solvers leave 1e-9 in the integral; light is conserved to rounding.
  column.value /= moment_rows_.row(0).dot(column.value);

  const Eigen::VectorXd exact = sampled(phase, travel);
  column.max_error = (interpolated(column.value) - exact).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff();
  return column;
}

}  // namespace cloudbow
