// Programmes of three values that the tests of both solvers share.
#pragma once

#include <vector>

#include "optics/fit_programme.hpp"

namespace cloudbow {

/// A sample at a control point itself.
inline Stencil at_point(int n) { return {{n, (n + 1) % 3, (n + 2) % 3}, {1, 0, 0}}; }

struct Rows {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
};

inline Rows sum_is(double sum) { return {Eigen::MatrixXd::Ones(1, 3), Eigen::VectorXd::Constant(1, sum)}; }

/// Sets the second and the third value.
inline Rows others_are(double second, double third) {
  Rows rows{Eigen::MatrixXd::Zero(2, 3), Eigen::Vector2d(second, third)};
  rows.matrix(0, 1) = rows.matrix(1, 2) = 1;
  return rows;
}

inline Rows contradiction() {
  Rows rows{Eigen::MatrixXd::Zero(2, 3), Eigen::Vector2d(1, 2)};
  rows.matrix(0, 1) = rows.matrix(1, 1) = 1;
  return rows;
}

inline FitProgramme programme_of(const std::vector<Stencil>& samples, const std::vector<double>& value,
                                 const Rows& rows) {
  const auto count = static_cast<Eigen::Index>(samples.size());
  FitProgramme programme;
  programme.samples = samples;
  programme.value = Eigen::Map<const Eigen::VectorXd>(value.data(), count);
  programme.scale = programme.mean_scale = Eigen::VectorXd::Ones(count);
  programme.rows = rows.matrix;
  programme.right = rows.right;
  return programme;
}

}  // namespace cloudbow
