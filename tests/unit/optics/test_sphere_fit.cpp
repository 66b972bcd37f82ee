// Fits of functions to control points. Truth: no change of a value brings a fit closer in its own measure.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/delta_m.hpp"
#include "cloudbow/optics/phase_fit.hpp"
#include "cloudbow/optics/sphere_fit.hpp"
#include "cloudbow/sphere/icosphere.hpp"
#include "fit_test_tools.hpp"

namespace cloudbow {
namespace {

class SphereFitTest : public testing::Test {
 protected:
  double largest(const Eigen::VectorXd& x, const Eigen::VectorXd& value, ResidualScale scale) const {
    return (fit.interpolated(x) - value).cwiseAbs().cwiseQuotient(residual_scale(value, scale)).maxCoeff();
  }
  const ControlPoints points{42};
  const SphereFit fit{points, make_icosphere(3).vertex};
};

// A function that the control points can represent has one fit without error: itself.
TEST_F(SphereFitTest, FindsAFunctionThatIsAnInterpolant) {
  Eigen::VectorXd x(points.size());
  for (int m = 0; m < points.size(); ++m) x[m] = 1 + Direction(0.3, -0.2, 0.5).dot(points.directions()[m]);
  const Eigen::VectorXd value = fit.interpolated(x);
  EXPECT_LE((fit.least_squares(value) - x).cwiseAbs().maxCoeff(), 1e-13);
  for (const ResidualScale scale : scales) {
    const auto found = fit.minimax(value, scale);
    ASSERT_TRUE(found);
    EXPECT_LE((*found - x).cwiseAbs().maxCoeff(), 1e-8);  // the simplex stops at 1e-9
  }
}

TEST_F(SphereFitTest, LeastSquaresLeavesAResidualThatNoChangeOfAControlPointReduces) {
  const Eigen::VectorXd value = values_of(PhaseFunction::henyey_greenstein(0.7), fit.samples(), {0, 0.6, 0.8});
  const Eigen::VectorXd x = fit.least_squares(value);
  const Eigen::VectorXd residual = fit.interpolated(x) - value;
  for (int m = 0; m < points.size(); ++m) {
    EXPECT_NEAR(fit.interpolated(Eigen::VectorXd::Unit(points.size(), m)).dot(residual), 0, 1e-12 * value.norm());
  }
}

// The problem is convex: a point that no small change improves is the optimum.
TEST_F(SphereFitTest, NoChangeImprovesAMinimaxFit) {
  const Eigen::VectorXd value = values_of(PhaseFunction::henyey_greenstein(0.7), fit.samples(), {0, 0.6, 0.8});
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const ResidualScale scale : scales) {
    const auto x = fit.minimax(value, scale);
    ASSERT_TRUE(x);
    const double h = largest(*x, value, scale);
    EXPECT_LE(h, largest(fit.least_squares(value), value, scale));
    for (const ResidualScale other : scales)
      EXPECT_LE(h, (1 + 1e-8) * largest(*fit.minimax(value, other), value, scale));
    for (int trial = 0; trial < 300; ++trial) {
      Eigen::VectorXd changed = *x;
      const double size = std::pow(10, -trial % 4);
      for (double& c : changed) c += size * normal(random);
      EXPECT_GE(largest(changed, value, scale), h * (1 - 1e-8));
    }
  }
}

// The same of the fits with rows and a least value, for changes that keep both.
TEST_F(SphereFitTest, NoChangeImprovesAConstrainedFit) {
  const Eigen::VectorXd value = values_of(PhaseFunction::henyey_greenstein(0.9), fit.samples(), {0, 0.6, 0.8});
  ConstrainedFit problem;
  problem.rows.matrix.resize(4, points.size());
  for (int m = 0; m < points.size(); ++m) problem.rows.matrix.col(m) << 1, points.directions()[m];
  problem.rows.matrix /= points.size();
  problem.rows.right = Eigen::Vector4d(1, 0, 0.3, 0.4);
  problem.lower = 0.2;
  problem.scale = value.cwiseSqrt();
  problem.mean_scale = value.cwiseAbs().cwiseMax(0.3);
  const Eigen::MatrixXd rows = problem.rows.matrix;
  const auto largest_error = [&](const Eigen::VectorXd& x) {
    return (fit.interpolated(x) - value).cwiseAbs().cwiseQuotient(problem.scale).maxCoeff();
  };
  const auto objective = [&](const ConstrainedFit& of, const Eigen::VectorXd& x) {
    const Eigen::VectorXd error = (fit.interpolated(x) - value).cwiseAbs();
    return (of.minimax && !of.bound ? largest_error(x) : 0) +
           of.mean_weight * error.cwiseQuotient(of.mean_scale).mean();
  };
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  const auto expect_no_improvement = [&](const ConstrainedFit& of, double bound) {
    int programmes = 0;
    const auto x = fit.constrained(value, of, programmes);
    ASSERT_TRUE(x);
    EXPECT_EQ(programmes, 1);
    EXPECT_LE((rows * *x - of.rows.right).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_GE(x->minCoeff(), of.lower);
    EXPECT_LT(x->minCoeff(), of.lower + 1e-3);  // the least value is not idle here
    EXPECT_LE(largest_error(*x), bound);
    int tried = 0;
    for (int trial = 0; trial < 2000; ++trial) {
      Eigen::VectorXd change(points.size());
      for (double& c : change) c = normal(random);
      for (int m = 0; m < points.size(); ++m) {
        if ((*x)[m] < of.lower + 1e-3) change[m] = 0;
      }
      // Onto the changes of the free values that the rows do not see.
      const Eigen::MatrixXd free = rows * (x->array() >= of.lower + 1e-3).cast<double>().matrix().asDiagonal();
      change -= free.transpose() * (free * free.transpose()).ldlt().solve(free * change);
      const Eigen::VectorXd changed = *x + std::pow(10, -1 - trial % 4) * change;
      if (changed.minCoeff() < of.lower) continue;
      if (largest_error(changed) > bound) continue;
      ++tried;
      EXPECT_GE(objective(of, changed), objective(of, *x) * (1 - 1e-6));  // tolerance at which the solver stops
    }
    EXPECT_GT(tried, 20);
  };
  expect_no_improvement(problem, 1e9);
  problem.minimax = false;
  expect_no_improvement(problem, 1e9);
  problem.minimax = true;
  int programmes = 0;
  problem.bound = 1.1 * largest_error(*fit.constrained(value, problem, programmes));
  expect_no_improvement(problem, *problem.bound + 1e-6);
}

// Non-negative values cannot give light as strongly peaked as the rows require.
TEST_F(SphereFitTest, SaysThatRowsHaveNoSolution) {
  const Eigen::VectorXd value = values_of(PhaseFunction::henyey_greenstein(0.7), fit.samples(), {0, 0.6, 0.8});
  ConstrainedFit problem;
  problem.rows.matrix.resize(2, points.size());
  for (int m = 0; m < points.size(); ++m) problem.rows.matrix.col(m) << 1, points.directions()[m].z();
  problem.rows.matrix /= points.size();
  problem.rows.right.resize(2);
  problem.rows.right << 1, 1.01;
  problem.scale = problem.mean_scale = value.cwiseSqrt();
  int programmes = 0;
  EXPECT_FALSE(fit.constrained(value, problem, programmes));
}

TEST_F(SphereFitTest, MinimaxScalesWithTheFunction) {
  const Eigen::VectorXd value = values_of(PhaseFunction::henyey_greenstein(0.7), fit.samples(), {0, 0.6, 0.8});
  const double h = largest(*fit.minimax(value, ResidualScale::absolute), value, ResidualScale::absolute);
  const Eigen::VectorXd more = 10 * value;
  EXPECT_NEAR(largest(*fit.minimax(more, ResidualScale::absolute), more, ResidualScale::absolute), 10 * h, 1e-7 * h);
}

TEST_F(SphereFitTest, RejectsSamplesThatDoNotDetermineTheValues) {
  EXPECT_THROW(SphereFit(points, {Direction::UnitZ(), Direction::UnitX()}), InputError);
}

}  // namespace
}  // namespace cloudbow
