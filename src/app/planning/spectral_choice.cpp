#include "app/planning/spectral_choice.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace cloudbow {
namespace {

// A gradient or a reduced column below this fraction of its terms is rounding.
constexpr double rounding = 1e-13;

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// Unconstrained least squares on some columns of unit length.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, const std::vector<int>& columns) {
  Eigen::MatrixXd part(a.rows(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) part.col(static_cast<Eigen::Index>(i)) = a.col(columns[i]);
  return part.colPivHouseholderQr().solve(b);
}

// Lawson and Hanson 1974, algorithm NNLS (23.10). @param a columns of length 1 or 0.
Eigen::VectorXd solve_nnls(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  const auto n = static_cast<int>(a.cols());
  const double tolerance = rounding * b.norm();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  std::vector<int> positive;  // the columns with x > 0, ascending
  // Each step leaves a smaller residual, so the loop ends; the limit guards against rounding.
  for (int step = 0; step < 10 * n; ++step) {
    Eigen::VectorXd gradient = a.transpose() * (b - a * x);
    for (const int j : positive) gradient[j] = 0;
    Eigen::VectorXd solution;
    std::vector<int> tried;
    while (true) {
      Eigen::Index most = 0;
      if (n == 0 || !(gradient.maxCoeff(&most) > tolerance)) return x;
      tried = positive;
      tried.insert(std::lower_bound(tried.begin(), tried.end(), static_cast<int>(most)), static_cast<int>(most));
      solution = least_squares(a, b, tried);
      const auto place = std::find(tried.begin(), tried.end(), static_cast<int>(most)) - tried.begin();
      if (solution[place] > 0) break;
      gradient[most] = 0;  // positive by rounding alone
    }
    positive = tried;
    while (!positive.empty() && !(solution.minCoeff() > 0)) {
      // The part of the way to `solution` on which no x turns negative.
      double way = 1;
      for (std::size_t i = 0; i < positive.size(); ++i) {
        const double to = solution[static_cast<Eigen::Index>(i)], from = x[positive[i]];
        if (to <= 0) way = from > 0 ? std::min(way, from / (from - to)) : 0;
      }
      std::vector<int> left;
      for (std::size_t i = 0; i < positive.size(); ++i) {
        const double to = solution[static_cast<Eigen::Index>(i)];
        double& value = x[positive[i]];
        const bool ends = to <= 0 && (value <= 0 || value / (value - to) <= way);
        value = ends ? 0 : value + way * (to - value);
        if (!ends) left.push_back(positive[i]);
      }
      positive = left;
      if (!positive.empty()) solution = least_squares(a, b, positive);
    }
    for (std::size_t i = 0; i < positive.size(); ++i) x[positive[i]] = solution[static_cast<Eigen::Index>(i)];
  }
  return x;
}

// The rows of a choice, turned by an orthogonal matrix into no more than there are columns: norms stay.
class Rows {
 public:
  explicit Rows(std::span<const ColumnAnswers> of_points);

  struct Fit {
    double residual = std::numeric_limits<double>::infinity();
    Eigen::VectorXd weight;  // of the points
  };
  Fit fit(const std::vector<int>& points) const;

  // Puts the best point in place of `points[place]`; the one that is there, if none is better. True if it is another.
  bool improve(std::vector<int>& points, std::size_t place, const std::vector<int>& candidates, Fit& best) const;

 private:
  Eigen::MatrixXd column_;  // of unit length
  Eigen::VectorXd length_;  // before
  Eigen::VectorXd sum_;     // of all points
};

using Member = std::vector<double> ColumnAnswers::*;

// Truth of a field: the sum of all points.
std::vector<double> sum_of_all(std::span<const ColumnAnswers> of_points, Member field) {
  std::vector<double> sum;
  for (const ColumnAnswers& point : of_points) {
    if (point.power <= 0) continue;
    sum.resize((point.*field).size());
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += point.power * (point.*field)[i];
  }
  return sum;
}

// Unit of the rows of a field: its mean. Net absorption in thermal scenes can have a mean near 0; then half its RMS.
double unit_of(const std::vector<double>& truth) {
  double mean = 0;
  for (const double value : truth) mean += value / static_cast<double>(truth.size());
  return std::max(std::abs(mean), .5 * std::sqrt(dot(truth, truth) / static_cast<double>(truth.size())));
}

// Unit of heating rates: the largest, over their weight. With less weight fluxes gain nothing, with more they lose.
constexpr double weight_of_heating = .3;

double unit_of_heating(const std::vector<double>& truth) {
  double most = 0;
  for (const double value : truth) most = std::max(most, std::abs(value));
  return most / weight_of_heating;
}

// Sum of the weights, relative: so strong that it is kept to about the residual over its square.
constexpr double weight_of_sum = 100;

Rows::Rows(std::span<const ColumnAnswers> of_points) {
  const auto n = static_cast<Eigen::Index>(of_points.size());
  double power = 0;
  for (const ColumnAnswers& point : of_points) power += std::max(point.power, 0.);
  constexpr Member fields[] = {&ColumnAnswers::up, &ColumnAnswers::down, &ColumnAnswers::absorbed,
                               &ColumnAnswers::heating};
  Eigen::Index rows = 1;
  for (const Member field : fields) rows += static_cast<Eigen::Index>(sum_of_all(of_points, field).size());
  // One row per value; the last column is the truth. Weights count in units of all power.
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(rows, n + 1);
  Eigen::Index row = 0;
  for (const Member field : fields) {
    const std::vector<double> truth = sum_of_all(of_points, field);
    const double unit = field == &ColumnAnswers::heating ? unit_of_heating(truth) : unit_of(truth);
    if (truth.empty() || !(unit > 0)) continue;
    const double scale = 1 / (unit * std::sqrt(static_cast<double>(truth.size())));
    for (std::size_t i = 0; i < truth.size(); ++i, ++row) {
      for (Eigen::Index g = 0; g < n; ++g) {
        if (of_points[g].power > 0) matrix(row, g) = scale * power * (of_points[g].*field)[i];
      }
      matrix(row, n) = scale * truth[i];
    }
  }
  for (Eigen::Index g = 0; g < n; ++g) matrix(row, g) = of_points[g].power > 0 ? weight_of_sum : 0;
  matrix(row, n) = power > 0 ? weight_of_sum : 0;

  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(matrix);
  const Eigen::Index kept = std::min(rows, n + 1);
  const Eigen::MatrixXd triangle = qr.matrixQR().topRows(kept).triangularView<Eigen::Upper>();
  column_ = triangle.leftCols(n);
  sum_ = triangle.col(n);
  length_ = column_.colwise().norm() / power;
  for (Eigen::Index g = 0; g < n; ++g) {
    if (length_[g] > 0) column_.col(g) /= length_[g] * power;
  }
}

Rows::Fit Rows::fit(const std::vector<int>& points) const {
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd part(column_.rows(), n);
  for (Eigen::Index i = 0; i < n; ++i) part.col(i) = column_.col(points[i]);
  Fit result;
  // Mostly no constraint is active.
  result.weight = part.colPivHouseholderQr().solve(sum_);
  if (!(result.weight.minCoeff() > 0)) result.weight = solve_nnls(part, sum_);
  result.residual = (part * result.weight - sum_).norm();
  for (Eigen::Index i = 0; i < n; ++i) result.weight[i] /= length_[points[i]];
  return result;
}

bool Rows::improve(std::vector<int>& points, std::size_t place, const std::vector<int>& candidates, Fit& best) const {
  const int before = points[place];
  // Parts of the sum and of a candidate that are perpendicular to the other points. They bound the residual.
  const auto others = static_cast<Eigen::Index>(points.size() - 1);
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(column_.rows(), others);
  const auto without_others = [&](Eigen::VectorXd v, Eigen::Index count) {
    for (int twice = 0; twice < 2; ++twice) v -= basis.leftCols(count) * (basis.leftCols(count).transpose() * v);
    return v;
  };
  Eigen::Index count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i == place) continue;
    const Eigen::VectorXd rest = without_others(column_.col(points[i]), count);
    if (rest.norm() > rounding) basis.col(count++) = rest / rest.norm();
  }
  const Eigen::VectorXd sum = without_others(sum_, count);
  int chosen = before;
  for (const int g : candidates) {
    if (std::find(points.begin(), points.end(), g) != points.end()) continue;
    const Eigen::VectorXd rest = without_others(column_.col(g), count);
    const double part = rest.norm() > rounding ? rest.dot(sum) / rest.norm() : 0;
    const double bound = std::sqrt(std::max(0., sum.squaredNorm() - part * part));
    if (!(bound < best.residual)) continue;
    std::vector<int> trial = points;
    trial[place] = g;
    Fit other = fit(trial);
    // Not for rounding: that could go round in circles.
    if (!(other.residual < best.residual * (1 - 1e-9))) continue;
    best = std::move(other);
    chosen = g;
  }
  points[place] = chosen;
  return chosen != before;
}

using Means = std::vector<double> LevelMeans::*;

// The truth of the columns less the sum of the chosen.
LevelMeans missing_means(std::span<const ColumnAnswers> of_points, const SpectralChoice& choice) {
  LevelMeans missing;
  for (const Means means :
       {&LevelMeans::up, &LevelMeans::down_diffuse, &LevelMeans::direct, &LevelMeans::absorbed, &LevelMeans::light}) {
    const auto add = [&](double factor, const ColumnAnswers& point) {
      const std::vector<double>& from = point.means.*means;
      (missing.*means).resize(from.size());
      for (std::size_t i = 0; i < from.size(); ++i) (missing.*means)[i] += factor * from[i];
    };
    for (std::size_t g = 0; g < of_points.size(); ++g) {
      const auto place = std::find(choice.point.begin(), choice.point.end(), static_cast<int>(g));
      const double weight = place == choice.point.end() ? 0 : choice.weight[place - choice.point.begin()];
      if (of_points[g].power > 0) add(of_points[g].power - weight, of_points[g]);
    }
  }
  return missing;
}

// Exchanges until none is better, at most that often: each makes the residual smaller.
constexpr int most_passes = 5;

}  // namespace

std::vector<double> non_negative_least_squares(std::span<const std::vector<double>> columns,
                                               std::span<const double> b) {
  const auto n = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd a(static_cast<Eigen::Index>(b.size()), n);
  Eigen::VectorXd length(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    a.col(j) = Eigen::Map<const Eigen::VectorXd>(columns[j].data(), a.rows());
    length[j] = a.col(j).norm();
    if (length[j] > 0) a.col(j) /= length[j];
  }
  Eigen::VectorXd x = solve_nnls(a, Eigen::Map<const Eigen::VectorXd>(b.data(), a.rows()));
  for (Eigen::Index j = 0; j < n; ++j) {
    if (length[j] > 0) x[j] /= length[j];
  }
  return {x.begin(), x.end()};
}

SpectralChoice choose_points(std::span<const ColumnAnswers> of_points, double tolerance, int points) {
  std::vector<int> candidates;
  for (std::size_t g = 0; g < of_points.size(); ++g) {
    if (of_points[g].power > 0) candidates.push_back(static_cast<int>(g));
  }
  SpectralChoice choice;
  if (candidates.empty()) return choice;
  const Rows rows(of_points);
  const std::size_t most = points > 0 ? static_cast<std::size_t>(points) : candidates.size();
  std::vector<int> chosen;
  Rows::Fit best;
  while (chosen.size() < std::min(most, candidates.size())) {
    if (chosen.size() + 1 == candidates.size()) {  // all: nothing is left to choose
      for (const int g : candidates) choice.weight.push_back(of_points[g].power);
      choice.point = candidates;
      choice.missing = missing_means(of_points, choice);
      return choice;
    }
    const auto is_new = [&](int g) { return std::find(chosen.begin(), chosen.end(), g) == chosen.end(); };
    chosen.push_back(*std::find_if(candidates.begin(), candidates.end(), is_new));
    best = rows.fit(chosen);
    rows.improve(chosen, chosen.size() - 1, candidates, best);
    bool changes = true;
    for (int pass = 0; pass < most_passes && changes; ++pass) {
      changes = false;
      for (std::size_t i = 0; i < chosen.size(); ++i) changes = rows.improve(chosen, i, candidates, best) || changes;
    }
    if (best.residual <= tolerance) break;
  }
  std::vector<std::pair<int, double>> used;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const double weight = best.weight[static_cast<Eigen::Index>(i)];
    if (weight > 0) used.emplace_back(chosen[i], weight);
  }
  std::sort(used.begin(), used.end());
  for (const auto& [g, weight] : used) {
    choice.point.push_back(g);
    choice.weight.push_back(weight);
  }
  choice.residual = best.residual;
  choice.missing = missing_means(of_points, choice);
  return choice;
}

}  // namespace cloudbow
