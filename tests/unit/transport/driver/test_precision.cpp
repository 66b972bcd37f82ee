// Choice of precision. Truth: the limits that the header names.
#include <gtest/gtest.h>

#include <vector>

#include "transport/driver/precision.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

OpticalGrid half_cloudy(float optical_depth) {
  const BoxGrid box = make_box(4, 4, 2);
  std::vector<float> extinction(cells_of(box), 0.F);
  for (std::size_t c = 0; c < extinction.size(); c += 2) extinction[c] = optical_depth / 2;
  return make_grid(box, extinction, 1.);
}

TEST(Precision, VeryThickNeedsDouble) {
  EXPECT_FALSE(too_thick_for_float(half_cloudy(90)));
  EXPECT_TRUE(too_thick_for_float(half_cloudy(110)));  // 55 in a cell
}

TEST(Precision, SmallToleranceInACloudNeedsDoubleIfItFits) {
  SolverOptions options;
  options.tolerance = 1e-6;
  EXPECT_TRUE(tolerance_needs_double(half_cloudy(20), 16, options));
  EXPECT_FALSE(tolerance_needs_double(half_cloudy(1), 16, options));  // few scatterings
  EXPECT_FALSE(tolerance_needs_double(half_cloudy(20), 100000000, options));
  options.half_precision_radiance = true;
  EXPECT_FALSE(tolerance_needs_double(half_cloudy(20), 16, options));
  options.half_precision_radiance = false;
  options.tolerance = 1e-5;
  EXPECT_FALSE(tolerance_needs_double(half_cloudy(20), 16, options));
}

}  // namespace
}  // namespace cloudbow
