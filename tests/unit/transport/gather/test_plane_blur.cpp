#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
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

// Of a spike: the integral of the Gaussian over each column, whatever the count of columns along a row.
TEST(PlaneBlur, IsTheGaussianOfEachColumn) {
  constexpr double sigma = 2.5;  // columns
  for (const int nx : {40, 37, 64}) {
    const BoxGrid box = make_box(nx, 31, 1);
    std::vector<double> spike(box.columns(), 0.);
    spike[static_cast<std::size_t>(3 * nx + 1)] = 1;
    blur_plane(spike, box, sigma);
    const auto integral = [](double from, double to) {
      return .5 * (std::erf(to / (sigma * std::numbers::sqrt2)) - std::erf(from / (sigma * std::numbers::sqrt2)));
    };
    constexpr int reach = 8;  // three sigma
    const double all = integral(-reach - .5, reach + .5);
    const auto weight = [&](int d, int n) {
      const int distance = std::min((d % n + n) % n, n - (d % n + n) % n);
      return distance > reach ? 0. : integral(distance - .5, distance + .5) / all;
    };
    for (int j = 0; j < 31; ++j)
      for (int i = 0; i < nx; ++i)
        EXPECT_NEAR(spike[static_cast<std::size_t>(j * nx + i)], weight(i - 1, nx) * weight(j - 3, 31), 1e-14);
  }
}

}  // namespace
}  // namespace cloudbow
