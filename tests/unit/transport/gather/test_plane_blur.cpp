#include <gtest/gtest.h>

#include <numeric>

#include "transport/gather/plane_blur.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

TEST(PlaneBlur, KeepsTheSumAndAnEvenField) {
  for (const bool periodic : {true, false}) {
    BoxGrid box = make_box(9, 6, 1, periodic);
    box.dx_m = 50;
    box.dy_m = 80;
    for (const double sigma_m : {20., 60., 400.}) {
      std::vector<double> even(54, 2.);
      blur_plane(even, box, sigma_m);
      for (const double value : even) EXPECT_NEAR(value, 2, 1e-13);
      std::vector<double> spike(54, 0.);
      spike[1 * 9 + 0] = 1;
      blur_plane(spike, box, sigma_m);
      EXPECT_NEAR(std::accumulate(spike.begin(), spike.end(), 0.), 1, 1e-13);
      // A kernel that is cell-integrated has spread by 1/12 of a column at least.
      EXPECT_LT(spike[1 * 9 + 0], sigma_m > 40 ? .9 : 1);
      EXPECT_EQ(spike[1 * 9 + 8] > 0, periodic);
    }
  }
}

}  // namespace
}  // namespace cloudbow
