#include <gtest/gtest.h>

#include <cmath>

#include "cloudbow/core/error.hpp"
#include "transport/driver/path_load.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

Problem lit(double mu0, bool periodic = true) {
  const BoxGrid box = make_box(8, 6, 10, periodic);
  Problem problem;
  problem.grid = make_grid(box, random_extinction(box, 1, 2), .9);
  problem.phase = {PhaseFunction::isotropic()};
  problem.sun = Sun{travel_along(-mu0, 0), 1.};
  return problem;
}

// A ray crosses a face of a level each metre of height. Along x it crosses a face of a column each metre. The count is
// a bound: it has one more for each axis.
TEST(PathLoad, CountsTheFacesThatARayCrosses) {
  for (const double mu0 : {.9, .3, .02}) {
    const double along_x = 10 * std::sqrt(1 - mu0 * mu0) / mu0;
    EXPECT_NEAR(beam_segments(lit(mu0), coarse_options()), 10 + along_x, 3.5) << mu0;
  }
  SolverOptions columns = coarse_options();
  columns.independent_columns = true;
  columns.beam_crosses_columns = false;
  EXPECT_EQ(beam_segments(lit(.3), columns), 0);
}

TEST(PathLoad, LowSunsAreRefusedWithTheAngleThatIsSolved) {
  EXPECT_NO_THROW(check_paths(SolvePlan(lit(.01), coarse_options())));
  try {
    check_paths(SolvePlan(lit(1e-9), coarse_options()));
    FAIL() << "a ray of 1e10 segments";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("zenith angle of at most 89.99"), std::string::npos) << error.what();
  }
}

TEST(PathLoad, OpenSidesMustNotBringAllTheLight) {
  EXPECT_NO_THROW(check_paths(SolvePlan(lit(.1, false), coarse_options())));
  EXPECT_THROW(check_paths(SolvePlan(lit(1e-3, false), coarse_options())), InputError);
}

TEST(PathLoad, LongBeamsNeedDouble) {
  EXPECT_FALSE(beam_needs_double(lit(.1), coarse_options()));
  EXPECT_TRUE(beam_needs_double(lit(1e-5), coarse_options()));
}

TEST(PathLoad, MoreThreadsHoldMorePatterns) {
  PathLoad load;
  load.beam = 100;
  load.longest_diffuse = 1000;
  load.ordinates = 5000;
  EXPECT_LT(load.bytes(1), load.bytes(8));
  EXPECT_GT(load.bytes(1), 6000 * 8.);
}

}  // namespace
}  // namespace cloudbow
