// The same programmes by the interior-point method. Truth: closed forms, and the objective that the simplex method
// reaches.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "cloudbow/optics/phase_function.hpp"
#include "optics/interior_point.hpp"
#include "programme_test_tools.hpp"

namespace cloudbow {
namespace {

constexpr double relative_gap = 1e-6;  // at which the method stops

double objective(const FitProgramme& programme, const Eigen::VectorXd& x) {
  double largest = 0, mean = 0;
  for (std::size_t i = 0; i < programme.samples.size(); ++i) {
    double fitted = 0;
    for (int k = 0; k < 3; ++k) fitted += programme.samples[i].weight[k] * x[programme.samples[i].index[k]];
    const double error = std::abs(fitted - programme.value[i]);
    largest = std::max(largest, error / programme.scale[i]);
    mean += error / programme.mean_scale[i];
  }
  const double of_mean = programme.mean_weight * mean / static_cast<double>(programme.samples.size());
  return (programme.largest == LargestResidual::minimised ? largest : 0) + of_mean;
}

// The sum of the residuals is given. Their mean is least if none has another sign, and their largest if all are the
// same. The objective is 21 times the residual .3; an error of 1e-6 in it is 2.1e-5 in a residual.
TEST(InteriorPoint, FindsTheOptimumInClosedForm) {
  const std::vector<Stencil> samples{at_point(0), at_point(1), at_point(2)};
  const FitProgramme programme = programme_of(samples, {.2, .5, 1.4}, sum_is(3));
  const auto x = solve_by_interior_point(programme, NormalPattern(samples, 3));
  ASSERT_TRUE(x);
  EXPECT_NEAR(objective(programme, *x), .3 * (1 + programme.mean_weight), 2 * .3 * 21 * relative_gap);
  EXPECT_LT((*x - Eigen::Vector3d(.5, .8, 1.7)).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(InteriorPoint, HasNoAnswerIfTheRowsContradict) {
  const std::vector<Stencil> samples(3, at_point(0));
  EXPECT_FALSE(solve_by_interior_point(programme_of(samples, {1, 1, 1}, contradiction()), NormalPattern(samples, 3)));
}

// A peak between the control points of an icosphere.
TEST(InteriorPoint, ReachesTheObjectiveOfTheSimplexMethod) {
  const ControlPoints points(42);
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(.7);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Stencil> samples;
  std::vector<double> value;
  for (int n = 0; n < 300; ++n) {
    const Direction direction = Direction(normal(random), normal(random), normal(random)).normalized();
    samples.push_back(points.stencil(direction));
    value.push_back(phase(direction.x()));
  }
  const Rows mean_is_one{Eigen::MatrixXd::Constant(1, 42, 1. / 42), Eigen::VectorXd::Ones(1)};
  for (const LargestResidual largest : {LargestResidual::minimised, LargestResidual::free}) {
    FitProgramme programme = programme_of(samples, value, mean_is_one);
    programme.largest = largest;
    const auto simplex = solve(programme, Simplex::primal);
    const auto interior = solve_by_interior_point(programme, NormalPattern(samples, 42));
    ASSERT_TRUE(simplex && interior);
    EXPECT_NEAR(objective(programme, *interior) / objective(programme, *simplex), 1, 2 * relative_gap);
    EXPECT_GE(interior->minCoeff(), 0);
    EXPECT_NEAR(interior->mean(), 1, 1e-9);
  }
}

}  // namespace
}  // namespace cloudbow
