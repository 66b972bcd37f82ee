#include "column_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "cloudbow/sphere/icosphere.hpp"
#include "cloudbow/sphere/spherical_harmonics.hpp"

namespace cloudbow {
namespace {

constexpr double four_pi = 4 * std::numbers::pi;
constexpr double tiny = 1e-12;  // an entry below represents 0, see FitProgramme

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

/// The icosphere with about four times as many vertices as there are control points, at least 642, in their frame.
std::vector<Direction> sample_directions(const ControlPoints& points) {
  std::vector<Direction> sample;
  for (const Direction& v : make_icosphere(points.size() > 162 ? 4 : 3).vertex) sample.push_back(points.rotation() * v);
  return sample;
}

}  // namespace

ColumnFit::ColumnFit(const ControlPoints& points, const OrdinateSet& ordinates, const FitOptions& options)
    : points_(points), options_(options), fit_(points, sample_directions(points)) {
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
  Eigen::VectorXd value(fit_.samples().size());
  for (std::size_t i = 0; i < fit_.samples().size(); ++i) value[i] = phase(fit_.samples()[i].dot(travel));
  return value;
}

Eigen::VectorXd ColumnFit::at_points(const PhaseFunction& phase, const Direction& travel) const {
  Eigen::VectorXd value(points_.size());
  for (int m = 0; m < points_.size(); ++m) value[m] = phase(points_.directions()[m].dot(travel));
  return value;
}

template <class Attempt>
void ColumnFit::fit_with_fewer_rows(FittedColumn& column, const PhaseFunction& phase, const Direction& travel,
                                    int half_range_rows, const Attempt& attempt) const {
  // The programme may have no positive solution (a coarse set of points, a strong peak). Then fewer moments are
  // prescribed, then fewer half-range rows. The integral alone can always be prescribed.
  for (int half_range = half_range_rows; half_range >= 0; --half_range) {
    for (int degree = options_.exact_moments; degree >= (half_range > 0 ? std::min(1, options_.exact_moments) : 0);
         --degree) {
      if (auto x = attempt(exact_rows(phase, travel, degree, half_range))) {
        column.value = std::move(*x);
        column.exact_degree = degree;
        return;
      }
      column.fell_back = true;
    }
  }
  column.exact_degree = std::min(3, options_.exact_moments);
  column.value =
      corrected(exact_rows(phase, travel, column.exact_degree, 0), fit_.least_squares(sampled(phase, travel)));
}

ConstrainedFit ColumnFit::objective(const PhaseFunction& phase, const Eigen::VectorXd& value) const {
  ConstrainedFit fit;
  fit.scale = value.cwiseAbs().cwiseMax(0.05).cwiseSqrt();
  fit.mean_scale = fit.scale;
  fit.minimax = options_.minimax;
  fit.lower = std::min(0.0, least_value(phase));
  return fit;
}

FittedColumn ColumnFit::fit(const PhaseFunction& phase, const Direction& travel, int half_range_rows) const {
  FittedColumn column;
  if (phase.is_isotropic()) {
    column.value = Eigen::VectorXd::Ones(points_.size());
    column.exact_degree = options_.exact_moments;
  } else if (options_.method == FitMethod::linear_programming) {
    const Eigen::VectorXd value = sampled(phase, travel);
    ConstrainedFit programme = objective(phase, value);
    fit_with_fewer_rows(column, phase, travel, half_range_rows, [&](ExactRows rows) {
      programme.rows = std::move(rows);
      return fit_.constrained(value, programme, column.linear_programmes);
    });
  } else {
    const bool collocated = options_.method == FitMethod::collocation;
    const Eigen::VectorXd plain = collocated ? at_points(phase, travel) : fit_.least_squares(sampled(phase, travel));
    column.value = corrected(exact_rows(phase, travel, options_.exact_moments, half_range_rows), plain);
    column.exact_degree = options_.exact_moments;
  }
  finish(column, phase, travel);
  return column;
}

FittedColumn ColumnFit::fit_bounded(const PhaseFunction& phase, const Direction& travel, double bound) const {
  const Eigen::VectorXd value = sampled(phase, travel);
  ConstrainedFit programme = objective(phase, value);
  programme.scale.setOnes();
  FittedColumn column;
  fit_with_fewer_rows(column, phase, travel, 0, [&](ExactRows rows) -> std::optional<Eigen::VectorXd> {
    programme.rows = std::move(rows);
    programme.bound = bound;
    if (auto x = fit_.constrained(value, programme, column.linear_programmes)) return x;
    // The least largest residual that the rows allow, and 1.001 times that: at the optimum itself rounding decides
    // whether a solution exists.
    ConstrainedFit least = programme;
    least.bound.reset();
    least.minimax = true;
    least.mean_weight = 0;
    const auto x = fit_.constrained(value, least, column.linear_programmes);
    if (!x) return std::nullopt;
    programme.bound = std::max(bound, 1.001 * (fit_.interpolated(*x) - value).cwiseAbs().maxCoeff());
    const auto better = fit_.constrained(value, programme, column.linear_programmes);
    return better ? better : x;
  });
  finish(column, phase, travel);
  return column;
}

void ColumnFit::polish(FittedColumn& column, const PhaseFunction& phase, const Direction& travel) const {
  if (column.exact_degree < 0) return;
  column.value = corrected(exact_rows(phase, travel, column.exact_degree, 0), column.value);
  finish(column, phase, travel);
}

void ColumnFit::finish(FittedColumn& column, const PhaseFunction& phase, const Direction& travel) const {
  // Solvers leave 1e-9 in the integral; light is conserved to rounding.
  column.value /= moment_rows_.row(0).dot(column.value);

  const Eigen::VectorXd exact = sampled(phase, travel);
  column.max_error = (fit_.interpolated(column.value) - exact).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff();
}

double ColumnFit::moment(const Eigen::VectorXd& value, const Direction& travel, int l) const {
  const Direction local = points_.rotation().transpose() * travel;
  const Eigen::VectorXd harmonics = real_spherical_harmonics(std::span(&local, 1), l);
  const auto first = harmonic_index(l, -l), count = 2 * l + 1;
  const Eigen::VectorXd seen = moment_rows_.middleRows(first, count) * value;
  return std::sqrt(four_pi) * harmonics.segment(first, count).dot(seen) / count;
}

}  // namespace cloudbow
