// The fit of a function as a linear programme. Truth: programmes of a few values whose optimum has a closed form.
#include <gtest/gtest.h>

#include <vector>

#include "programme_test_tools.hpp"

namespace cloudbow {
namespace {

constexpr double tolerance = 1e-9;  // that of the simplex method

// If the sum is given and only the largest residual counts, all residuals are the same.
TEST(FitProgramme, TheLargestResidualIsSpreadEvenly) {
  const std::vector<Stencil> samples{at_point(0), at_point(1), at_point(2)};
  FitProgramme programme = programme_of(samples, {.2, .5, 1.4}, sum_is(3));
  programme.mean_weight = 0;
  for (const Simplex algorithm : {Simplex::primal, Simplex::dual}) {
    const auto x = solve(programme, algorithm);
    ASSERT_TRUE(x);
    EXPECT_LT((*x - Eigen::Vector3d(.5, .8, 1.7)).cwiseAbs().maxCoeff(), tolerance);
  }
}

// The value of least mean distance is the median, whatever the outliers.
TEST(FitProgramme, TheLeastMeanResidualIsThatOfTheMedian) {
  const std::vector<Stencil> samples(5, at_point(0));
  FitProgramme programme = programme_of(samples, {1, 10, 3, 2, 40}, others_are(1, 2));
  programme.largest = LargestResidual::free;
  const auto x = solve(programme, Simplex::primal);
  ASSERT_TRUE(x);
  EXPECT_LT((*x - Eigen::Vector3d(3, 1, 2)).cwiseAbs().maxCoeff(), tolerance);
}

// No residual may exceed 4 here, which lifts the value from the median to 36.
TEST(FitProgramme, ABoundHoldsForEachResidual) {
  const std::vector<Stencil> samples(3, at_point(0));
  FitProgramme programme = programme_of(samples, {33, 34, 40}, others_are(1, 2));
  programme.largest = LargestResidual::bounded;
  programme.bound = 4;
  const auto x = solve(programme, Simplex::primal);
  ASSERT_TRUE(x);
  EXPECT_NEAR((*x)[0], 36, tolerance);
}

TEST(FitProgramme, ValuesKeepTheirLowerBoundIfThereIsOne) {
  const std::vector<Stencil> samples(3, at_point(0));
  FitProgramme programme = programme_of(samples, {-3, -3, -3}, others_are(1, 2));
  EXPECT_NEAR((*solve(programme, Simplex::primal))[0], 0, tolerance);
  programme.lower = -1;
  EXPECT_NEAR((*solve(programme, Simplex::primal))[0], -1, tolerance);
  programme.lower.reset();
  EXPECT_NEAR((*solve(programme, Simplex::primal))[0], -3, tolerance);
}

TEST(FitProgramme, RowsThatContradictHaveNoSolution) {
  const std::vector<Stencil> samples(3, at_point(0));
  EXPECT_FALSE(solve(programme_of(samples, {1, 1, 1}, contradiction()), Simplex::primal));
}

}  // namespace
}  // namespace cloudbow
