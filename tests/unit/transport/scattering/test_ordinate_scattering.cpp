// Radiance becomes source at the ordinates, whichever form of the matrices does it. Truth: the sum over ordinates.
#include <gtest/gtest.h>

#include <vector>

#include "transport/grid/cells.hpp"
#include "transport/scattering/discretisation.hpp"
#include "transport/scattering/ordinate_scattering.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

// The first set is symmetric about all coordinate planes, so that matrices are folded; control points are not.
class OrdinateScatteringTest : public testing::TestWithParam<const char*> {};

TEST_P(OrdinateScatteringTest, IsTheSumOverOrdinates) {
  SolverOptions options = coarse_options();
  options.directions = GetParam();
  const Discretisation made = discretise({PhaseFunction::henyey_greenstein(.6)}, std::nullopt, options);
  const BoxGrid box = make_box(3, 2, 2);
  const OpticalGrid grid = make_grid(box, random_extinction(box, 2, 3, true), .9);
  const std::vector<double> untruncated{0.};
  const auto cells = make_cells<double>(grid, untruncated, false);
  const DenseMatrix<double> matrix = made.table[0].ordinates_from_ordinates;
  const OrdinateScattering<double> scattering(made.ordinates, {matrix});

  const int count = made.ordinates.size();
  AngularField<double> field(count, cells.size());
  Random random(5);
  Eigen::MatrixXd radiance(count, cells.size());
  for (int d = 0; d < count; ++d) {
    for (std::size_t c = 0; c < cells.size(); ++c) radiance(d, c) = field.row(d)[c] = random();
  }
  std::vector<double> moments(low_moments * cells.size());
  scattering.moments_of(field, moments);
  scattering.scatter_in_place(field, cells, {});
  const Eigen::MatrixXd source = matrix * radiance;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    double integral = 0;
    for (int d = 0; d < count; ++d) {
      EXPECT_NEAR(field.row(d)[c], cells.scattered[0][c] * source(d, c), 1e-12);
      integral += made.ordinates.weight[d] * radiance(d, c);
    }
    EXPECT_NEAR(moments[c], integral, 1e-12 * integral);
  }
}

INSTANTIATE_TEST_SUITE_P(Sets, OrdinateScatteringTest, testing::Values("double-gauss-6x8", "control-points-42"));

}  // namespace
}  // namespace cloudbow
