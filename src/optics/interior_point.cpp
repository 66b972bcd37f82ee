#include "interior_point.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace cloudbow {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::VectorXd;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double gap_tolerance = 1e-6;   // of the objective: fluxes do not change below 1e-4
constexpr double row_tolerance = 1e-10;  // residual of the exact rows and of the dual's
constexpr int most_iterations = 60;      // a programme that has a solution takes 10 to 25
constexpr double to_boundary = 0.995;    // of the step at which a variable becomes 0

// Let Z = X - lower, r = A X - value, t_i >= |r_i| and c_i = mean_weight / (n mean_scale_i). The programme is
//   minimise h + c.t  subject to  t - r >= 0, t + r >= 0, scale h - t >= 0, Z >= 0, C X = right.
// h is a variable, given, or without limit (then scale h - t is omitted). The slacks are above, below, rest and Z, each
// with a multiplier. The start has all of them positive and consistent with X, t, h. So only C X = right and the dual's
// rows over X are violated at the start.

/// A value for each inequality: slacks, multipliers, or right sides of s * multiplier = ...
struct Inequalities {
  ArrayXd above, below, rest;  // per sample; rest is empty without limit
  ArrayXd z;                   // per control point

  double dot(const Inequalities& o) const {
    return (above * o.above).sum() + (below * o.below).sum() + (rest * o.rest).sum() + (z * o.z).sum();
  }
  double count() const { return static_cast<double>(above.size() + below.size() + rest.size() + z.size()); }
  void add(double step, const Inequalities& o) {
    above += step * o.above;
    below += step * o.below;
    rest += step * o.rest;
    z += step * o.z;
  }
};

/// The step at which the first of the values, all positive, becomes 0.
double step_to_zero(const Inequalities& value, const Inequalities& change) {
  const auto least = [](const ArrayXd& v, const ArrayXd& d) { return v.size() > 0 ? (d / v).minCoeff() : 0.0; };
  const double ratio = std::min({least(value.above, change.above), least(value.below, change.below),
                                 least(value.rest, change.rest), least(value.z, change.z)});
  return ratio < 0 ? -1 / ratio : 1e30;
}

struct NewtonStep {
  VectorXd x, row;  // row: multipliers of the exact rows
  double h = 0;
  ArrayXd t;
  Inequalities slack, multiplier;
};

class InteriorPoint {
 public:
  InteriorPoint(const FitProgramme& programme, const NormalPattern& pattern)
      : programme_(programme),
        pattern_(pattern),
        matrix_(pattern.matrix),
        lower_(*programme.lower),
        limited_(programme.largest != LargestResidual::free),
        minimised_(programme.largest == LargestResidual::minimised) {
    cost_ = programme.mean_weight / (static_cast<double>(programme.samples.size()) * programme.mean_scale.array());
    factor_.analyzePattern(matrix_);
    start();
  }

  std::optional<VectorXd> solve() {
    for (int iteration = 0; iteration < most_iterations; ++iteration) {
      const double gap = slack_.dot(multiplier_);
      const double objective = (minimised_ ? h_ : 0) + (cost_ * t_).sum();
      set_residuals();
      if (gap <= gap_tolerance * objective && row_residual_.lpNorm<Eigen::Infinity>() <= row_tolerance &&
          x_residual_.lpNorm<Eigen::Infinity>() <= gap_tolerance * objective) {
        return x_;
      }
      if (!std::isfinite(gap) || !set_system()) return std::nullopt;

      // Predictor: the full Newton step; corrector: towards the mean of the products, less if the predictor step was
      // long.
      const double mean = gap / slack_.count();
      const NewtonStep predicted = newton(products(0, nullptr));
      const double primal = std::min(1.0, step_to_zero(slack_, predicted.slack)),
                   dual = std::min(1.0, step_to_zero(multiplier_, predicted.multiplier));
      Inequalities slack = slack_, multiplier = multiplier_;
      slack.add(primal, predicted.slack);
      multiplier.add(dual, predicted.multiplier);
      const double centring = std::pow(slack.dot(multiplier) / gap, 3);
      advance(newton(products(centring * mean, &predicted)));
    }
    return std::nullopt;
  }

 private:
  Index points() const { return matrix_.rows(); }

  ArrayXd interpolated(const VectorXd& x) const {
    ArrayXd value(programme_.samples.size());
    for (Index i = 0; i < value.size(); ++i) {
      const auto& [index, weight] = programme_.samples[i];
      value[i] = weight[0] * x[index[0]] + weight[1] * x[index[1]] + weight[2] * x[index[2]];
    }
    return value;
  }

  VectorXd gathered(const ArrayXd& at_samples) const {
    VectorXd sum = VectorXd::Zero(points());
    for (Index i = 0; i < at_samples.size(); ++i) {
      const auto& [index, weight] = programme_.samples[i];
      for (int k = 0; k < 3; ++k) sum[index[k]] += weight[k] * at_samples[i];
    }
    return sum;
  }

  void start() {
    const double size = programme_.value.cwiseAbs().mean();
    const VectorXd sum = gathered(programme_.value.array()), total = gathered(ArrayXd::Ones(programme_.value.size()));
    x_ = sum.cwiseQuotient(total).cwiseMax(lower_ + 0.1 * size);
    const ArrayXd residual = interpolated(x_) - programme_.value.array();
    const double above_zero = 0.1 * size;
    t_ = residual.abs() + above_zero;
    slack_.above = t_ - residual;
    slack_.below = t_ + residual;
    slack_.z = x_.array() - lower_;
    const ArrayXd scale = programme_.scale.array();
    if (minimised_) h_ = 1.1 * (t_ / scale).maxCoeff();
    if (limited_ && !minimised_) {
      h_ = programme_.bound;
      // If h is given, no t may be feasible: the iteration makes slack and variable consistent.
      rest_residual_ = (1.1 * t_).max(scale * h_) - (scale * h_);
    }
    if (limited_) {
      slack_.rest = minimised_ ? ArrayXd(scale * h_ - t_) : ArrayXd(scale * h_ - t_ + rest_residual_);
      multiplier_.rest = minimised_ ? ArrayXd::Constant(t_.size(), 1 / scale.sum()) : cost_;
    }
    multiplier_.above = multiplier_.below = limited_ ? ArrayXd((cost_ + multiplier_.rest) / 2) : ArrayXd(cost_ / 2);
    multiplier_.z = ArrayXd::Constant(points(), cost_.mean());
    row_multiplier_ = VectorXd::Zero(programme_.rows.rows());
  }

  void set_residuals() {
    row_residual_ = programme_.right - programme_.rows * x_;
    x_residual_ = gathered(multiplier_.above - multiplier_.below) - multiplier_.z.matrix() -
                  programme_.rows.transpose() * row_multiplier_;
  }

  /// Right sides of s dm + m ds = centre - s m - (ds dm of the predictor).
  Inequalities products(double centre, const NewtonStep* predicted) const {
    Inequalities p;
    const auto product = [&](const ArrayXd Inequalities::*part) {
      ArrayXd right = centre - (slack_.*part) * (multiplier_.*part);
      if (predicted) right -= (predicted->slack.*part) * (predicted->multiplier.*part);
      return right;
    };
    p.above = product(&Inequalities::above);
    p.below = product(&Inequalities::below);
    p.rest = product(&Inequalities::rest);
    p.z = product(&Inequalities::z);
    return p;
  }

  /// Newton's equations without slacks, multipliers and t: N = A^T D A + diag(w_z) over X, bordered by h and the rows.
  bool set_system() {
    weight_.above = multiplier_.above / slack_.above;
    weight_.below = multiplier_.below / slack_.below;
    weight_.rest = multiplier_.rest / slack_.rest;
    weight_.z = multiplier_.z / slack_.z;
    const ArrayXd sum = weight_.above + weight_.below;
    t_weight_ = sum;
    if (limited_) t_weight_ += weight_.rest;
    ArrayXd d = 4 * weight_.above * weight_.below;
    if (limited_) d += sum * weight_.rest;
    d /= t_weight_;

    double* entry = matrix_.valuePtr();
    std::fill(entry, entry + matrix_.nonZeros(), 0.0);
    for (Index i = 0; i < d.size(); ++i) {
      const auto& w = programme_.samples[i].weight;
      const auto& at = pattern_.sample[i];
      const double w0 = d[i] * w[0], w1 = d[i] * w[1], w2 = d[i] * w[2];
      entry[at[0]] += w0 * w[0];
      entry[at[1]] += w1 * w[0];
      entry[at[2]] += w2 * w[0];
      entry[at[3]] += w1 * w[1];
      entry[at[4]] += w2 * w[1];
      entry[at[5]] += w2 * w[2];
    }
    for (Index m = 0; m < points(); ++m) entry[pattern_.diagonal[m]] += weight_.z[m];
    factor_.factorize(matrix_);
    if (factor_.info() != Eigen::Success) return false;

    // Half-solved: L^-1 of the rows and of h's column.
    const Index rows = programme_.rows.rows();
    border_.resize(points(), rows + 1);
    border_.leftCols(rows) = programme_.rows.transpose();
    border_.col(rows).setZero();
    if (minimised_) {
      h_column_ = -(weight_.above - weight_.below) * weight_.rest * programme_.scale.array() / t_weight_;
      border_.col(rows) = gathered(h_column_);
    }
    border_ = factor_.permutationP() * border_;
    forward(border_);
    Eigen::MatrixXd product = border_.transpose() * border_;
    coupling_ = product.col(rows).head(rows);
    Eigen::MatrixXd schur = product.topLeftCorner(rows, rows);
    if (minimised_) {
      h_pivot_ = (programme_.scale.array().square() * weight_.rest * sum / t_weight_).sum() - product(rows, rows);
      if (!(h_pivot_ > 0)) return false;
      schur += coupling_ * coupling_.transpose() / h_pivot_;
    }
    schur_.compute(schur);
    return schur_.info() == Eigen::Success;
  }

  /// x := L^-1 x, all columns at once.
  void forward(RowMatrix& x) const {
    const auto& lower = factor_.matrixL().nestedExpression();
    for (Index j = 0; j < lower.cols(); ++j) {
      Eigen::SparseMatrix<double>::InnerIterator entry(lower, j);
      x.row(j) /= entry.value();
      for (++entry; entry; ++entry) x.row(entry.index()) -= entry.value() * x.row(j);
    }
  }

  NewtonStep newton(const Inequalities& product) const {
    const ArrayXd scale = programme_.scale.array();
    const ArrayXd above = product.above / slack_.above, below = product.below / slack_.below;
    ArrayXd rest = product.rest / slack_.rest;
    if (rest_residual_.size() > 0) rest += weight_.rest * rest_residual_;
    const ArrayXd difference = weight_.above - weight_.below;
    ArrayXd t_right = above + below - cost_ + multiplier_.above + multiplier_.below;
    if (limited_) t_right -= rest + multiplier_.rest;
    const VectorXd right =
        (product.z / slack_.z).matrix() - x_residual_ - gathered(above - below - difference * t_right / t_weight_);

    const Index rows = programme_.rows.rows();
    VectorXd half = factor_.permutationP() * right;
    factor_.matrixL().solveInPlace(half);
    const VectorXd seen = border_.transpose() * half;
    NewtonStep step;
    double h_right = 0;
    VectorXd row_right = row_residual_ - seen.head(rows);
    if (minimised_) {
      h_right = (scale * (rest + weight_.rest * t_right / t_weight_)).sum() - 1 + (scale * multiplier_.rest).sum() -
                seen[rows];
      row_right += coupling_ * (h_right / h_pivot_);
    }
    step.row = schur_.solve(row_right);
    if (minimised_) step.h = (h_right - coupling_.dot(step.row)) / h_pivot_;
    half += border_.leftCols(rows) * step.row - border_.col(rows) * step.h;
    factor_.matrixU().solveInPlace(half);
    step.x = factor_.permutationPinv() * half;

    const ArrayXd residual = interpolated(step.x);
    step.t = t_right + difference * residual;
    if (minimised_) step.t += weight_.rest * scale * step.h;
    step.t /= t_weight_;
    step.slack.above = step.t - residual;
    step.slack.below = step.t + residual;
    step.slack.z = step.x.array();
    step.multiplier.above = above - weight_.above * step.slack.above;
    step.multiplier.below = below - weight_.below * step.slack.below;
    step.multiplier.z = product.z / slack_.z - weight_.z * step.slack.z;
    if (limited_) {
      step.slack.rest = scale * step.h - step.t;
      step.multiplier.rest = rest - weight_.rest * step.slack.rest;
      if (rest_residual_.size() > 0) step.slack.rest -= rest_residual_;
    }
    return step;
  }

  void advance(const NewtonStep& step) {
    const double primal = std::min(1.0, to_boundary * step_to_zero(slack_, step.slack)),
                 dual = std::min(1.0, to_boundary * step_to_zero(multiplier_, step.multiplier));
    x_ += primal * step.x;
    t_ += primal * step.t;
    h_ += primal * step.h;
    slack_.add(primal, step.slack);
    row_multiplier_ += dual * step.row;
    multiplier_.add(dual, step.multiplier);
    if (rest_residual_.size() > 0) rest_residual_ *= 1 - primal;
  }

  const FitProgramme& programme_;
  const NormalPattern& pattern_;
  Eigen::SparseMatrix<double> matrix_;  // N
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor_;
  double lower_;
  bool limited_, minimised_;
  ArrayXd cost_;

  VectorXd x_;
  ArrayXd t_;
  double h_ = 0;
  Inequalities slack_, multiplier_;
  VectorXd row_multiplier_;
  VectorXd row_residual_, x_residual_;
  ArrayXd rest_residual_;  // rest - (scale h - t) if h is given; else empty

  Inequalities weight_;
  ArrayXd t_weight_, h_column_;
  RowMatrix border_;
  VectorXd coupling_;  // rows' part of border^T border with h's column
  double h_pivot_ = 1;
  Eigen::LDLT<Eigen::MatrixXd> schur_;
};

}  // namespace

NormalPattern::NormalPattern(std::span<const Stencil> samples, int points) : matrix(points, points) {
  constexpr std::array<std::array<int, 2>, 6> pair = {{{0, 0}, {1, 0}, {2, 0}, {1, 1}, {2, 1}, {2, 2}}};
  const auto row_of = [&](const Stencil& s, int p) { return std::max(s.index[pair[p][0]], s.index[pair[p][1]]); };
  const auto column_of = [&](const Stencil& s, int p) { return std::min(s.index[pair[p][0]], s.index[pair[p][1]]); };
  std::vector<Eigen::Triplet<double>> entries;
  for (int m = 0; m < points; ++m) entries.emplace_back(m, m, 0.0);
  for (const Stencil& s : samples) {
    for (int p = 0; p < 6; ++p) entries.emplace_back(row_of(s, p), column_of(s, p), 0.0);
  }
  matrix.setFromTriplets(entries.begin(), entries.end());
  const auto position = [&](int row, int column) {
    const int* begin = matrix.innerIndexPtr() + matrix.outerIndexPtr()[column];
    const int* end = matrix.innerIndexPtr() + matrix.outerIndexPtr()[column + 1];
    return static_cast<int>(std::lower_bound(begin, end, row) - matrix.innerIndexPtr());
  };
  for (int m = 0; m < points; ++m) diagonal.push_back(position(m, m));
  for (const Stencil& s : samples) {
    auto& at = sample.emplace_back();
    for (int p = 0; p < 6; ++p) at[p] = position(row_of(s, p), column_of(s, p));
  }
}

std::optional<VectorXd> solve_by_interior_point(const FitProgramme& programme, const NormalPattern& pattern) {
  assert(programme.mean_weight > 0 && programme.lower);
  return InteriorPoint(programme, pattern).solve();
}

}  // namespace cloudbow
