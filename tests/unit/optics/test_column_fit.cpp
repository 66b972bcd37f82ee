// One column of a scattering table. Truth: moments of Henyey and Greenstein, and the isotropic function, which is 1.
#include <gtest/gtest.h>

#include <cmath>

#include "optics/column_fit.hpp"

namespace cloudbow {
namespace {

class ColumnFits : public testing::Test {
 protected:
  static FitOptions options() {
    FitOptions o;
    o.exact_moments = 2;
    o.beam_half_range_rows = 2;
    return o;
  }
  double worst_moment(const Eigen::VectorXd& value, const PhaseFunction& of, int degree) const {
    double worst = 0;
    for (int l = 0; l <= degree; ++l) worst = std::max(worst, std::abs(fit.moment(value, travel, l) - of.moment(l)));
    return worst;
  }

  const ControlPoints points{162};
  const OrdinateSet ordinates = make_ordinate_set("double-gauss-8x16");
  const ColumnFit fit{points, ordinates, options()};
  const Direction travel = Direction(.3, -.5, -.7).normalized();
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(.5);
};

TEST_F(ColumnFits, OfTheIsotropicFunctionAreOne) {
  const FittedColumn column = fit.fit(PhaseFunction::isotropic(), travel, 0);
  EXPECT_LT((column.value.array() - 1).abs().maxCoeff(), 1e-8);  // of the linear programme
  EXPECT_LT(column.max_error, 1e-8);
  EXPECT_FALSE(column.fell_back);
}

TEST_F(ColumnFits, HoldTheMomentsAndPolishingBringsThemToRounding) {
  FittedColumn column = fit.fit(phase, travel, 0);
  EXPECT_EQ(column.exact_degree, 2);
  EXPECT_LT(worst_moment(column.value, phase, 2), 1e-8);
  fit.polish(column, phase, travel);
  EXPECT_LT(worst_moment(column.value, phase, 2), 1e-13);
  EXPECT_GE(column.value.minCoeff(), 0);
}

TEST_F(ColumnFits, KeepABoundOnTheirResiduals) {
  const FittedColumn free = fit.fit(phase, travel, 0);
  const double bound = 2 * free.max_error;
  const FittedColumn column = fit.fit_bounded(phase, travel, bound);
  EXPECT_LE(column.max_error, bound * (1 + 1e-6));
  EXPECT_LT(worst_moment(column.value, phase, 2), 1e-8);
  // The least bound that the rows allow is below the residual of a fit that also weighs the mean.
  EXPECT_LE(fit.fit_bounded(phase, travel, 0).max_error, free.max_error * (1 + 1e-6));
}

TEST_F(ColumnFits, SampleTheFunctionAboutTheDirectionOfTravel) {
  const Eigen::VectorXd at_points = fit.at_points(phase, travel), sampled = fit.sampled(phase, travel);
  for (int m = 0; m < points.size(); ++m) EXPECT_EQ(at_points[m], phase(points.directions()[m].dot(travel)));
  ASSERT_EQ(static_cast<std::size_t>(sampled.size()), fit.sphere_fit().samples().size());
  for (Eigen::Index n = 0; n < sampled.size(); n += 50)
    EXPECT_EQ(sampled[n], phase(fit.sphere_fit().samples()[static_cast<std::size_t>(n)].dot(travel)));
}

}  // namespace
}  // namespace cloudbow
