#include "fit_programme.hpp"

#include <ClpSimplex.hpp>
#include <CoinError.hpp>
#include <CoinPackedMatrix.hpp>
#include <vector>

namespace cloudbow {
namespace {

/// Columns of a linear programme, built one after the other.
struct Columns {
  std::vector<CoinBigIndex> start{0};
  std::vector<int> row;
  std::vector<double> element, lower, upper, cost;

  void add_element(int at_row, double value) {
    if (value == 0) return;
    row.push_back(at_row);
    element.push_back(value);
  }
  void close(double least, double most, double price) {
    start.push_back(static_cast<CoinBigIndex>(row.size()));
    lower.push_back(least);
    upper.push_back(most);
    cost.push_back(price);
  }
};

}  // namespace

// The dual has as many rows as there are control points, far fewer than samples. The primal simplex starts from 0,
// which is feasible there: ten times faster than the programme as stated. With X = lower + Z, Z >= 0:
//   maximise y.(u+ - u- + v) + c.q  subject to  A^T (u+ - u- + v) + C^T q <= 0,  scale.(u+ + u-) <= 1,  |v_i| <=
//   mean_weight/(n mean_scale_i),
// u+, u- >= 0, q free. Z is the (negative) price of the first rows, h that of the last. If h is given, the last row is
// omitted and h scale.(u+ + u-) is subtracted from the objective. If X has any sign, the first rows are equalities.
std::optional<Eigen::VectorXd> solve(const FitProgramme& programme, Simplex algorithm) {
  const auto points = static_cast<int>(programme.rows.cols());
  const auto samples = static_cast<int>(programme.samples.size());
  const double infinity = COIN_DBL_MAX;
  const bool minimised = programme.largest == LargestResidual::minimised;
  const double lower = programme.lower.value_or(0);

  Columns columns;
  for (int i = 0; i < samples; ++i) {
    const Stencil& sample = programme.samples[i];
    const auto add_interpolation = [&](double sign) {
      for (int k = 0; k < 3; ++k) columns.add_element(sample.index[k], sign * sample.weight[k]);
    };
    const double above_lower = programme.value[i] - lower;
    if (programme.largest != LargestResidual::free) {
      for (const double sign : {1.0, -1.0}) {
        add_interpolation(sign);
        if (minimised) columns.add_element(points, programme.scale[i]);
        columns.close(0, infinity, -sign * above_lower + (minimised ? 0 : programme.bound * programme.scale[i]));
      }
    }
    if (programme.mean_weight > 0) {
      add_interpolation(1);
      const double most = programme.mean_weight / (samples * programme.mean_scale[i]);
      columns.close(-most, most, -above_lower);
    }
  }
  for (Eigen::Index q = 0; q < programme.rows.rows(); ++q) {
    for (int m = 0; m < points; ++m) columns.add_element(m, programme.rows(q, m));
    columns.close(-infinity, infinity, lower * programme.rows.row(q).sum() - programme.right[q]);
  }
  const int row_count = points + (minimised ? 1 : 0);
  std::vector<double> row_lower(row_count, programme.lower ? -infinity : 0.0);
  std::vector<double> row_upper(row_count, 0.0);
  if (minimised) {
    row_lower.back() = -infinity;
    row_upper.back() = 1;
  }

  try {
    const CoinPackedMatrix matrix(true, row_count, static_cast<int>(columns.cost.size()),
                                  static_cast<CoinBigIndex>(columns.row.size()), columns.element.data(),
                                  columns.row.data(), columns.start.data(), nullptr);
    ClpSimplex simplex;
    simplex.setLogLevel(0);
    simplex.scaling(0);  // weights lie in 0 to 1 as they are: scaling them costs a third of the time or more
    simplex.loadProblem(matrix, columns.lower.data(), columns.upper.data(), columns.cost.data(), row_lower.data(),
                        row_upper.data());
    simplex.setPrimalTolerance(1e-9);
    simplex.setDualTolerance(1e-9);
    // Not initialSolve(): it puts its own handler on SIGINT, and an interrupted run would go on.
    if (algorithm == Simplex::primal) {
      simplex.primal();
    } else {
      simplex.dual();
    }
    if (simplex.status() != 0) return std::nullopt;
    const Eigen::Map<const Eigen::VectorXd> price(simplex.getRowPrice(), points);
    return (lower - price.array()).matrix();
  } catch (const CoinError&) {
    return std::nullopt;
  }
}

}  // namespace cloudbow
