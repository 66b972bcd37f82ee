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

// Of a spike: the sum 1 and the variance of the Gaussian, apart from rounding. The peak of a quadratic spline is 6 %
// lower along each axis.
TEST(PlaneBlur, OfManyColumnsHasTheVarianceOfTheGaussian) {
  for (const double sigma : {10., 17.3, 40.}) {
    constexpr int nx = 401, ny = 301;
    const BoxGrid box = make_box(nx, ny, 1);
    std::vector<double> spike(box.columns(), 0.);
    spike[static_cast<std::size_t>(150 * nx + 200)] = 1;
    blur_plane(spike, box, sigma);
    double sum = 0, x2 = 0, y2 = 0;
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        const double value = spike[static_cast<std::size_t>(j * nx + i)];
        const double x = i - 200, y = j - 150;
        sum += value;
        x2 += value * x * x;
        y2 += value * y * y;
        const double peak = 1 / (2 * std::numbers::pi * sigma * sigma);
        EXPECT_NEAR(value, peak * std::exp(-(x * x + y * y) / (2 * sigma * sigma)), .13 * peak);
      }
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_NEAR(x2, sigma * sigma, 1e-9 * sigma * sigma);
    EXPECT_NEAR(y2, sigma * sigma, 1e-9 * sigma * sigma);
  }
}

// Blurs up to widths beyond the box, of a spike next to a side or to the periodic seam. The tolerances are rounding.
TEST(PlaneBlur, AsWideAsTheBoxKeepsTheSumAndAnEvenField) {
  for (const bool periodic : {true, false}) {
    for (const int nx : {60, 61, 400}) {
      const BoxGrid box = make_box(nx, 45, 1, periodic);
      for (const double sigma : {12., 50., 1e3}) {
        std::vector<double> even(box.columns(), 2.), spike(box.columns(), 0.);
        blur_plane(even, box, sigma);
        for (const double value : even) EXPECT_NEAR(value, 2, 1e-12);
        spike[1] = 1;
        blur_plane(spike, box, sigma);
        EXPECT_NEAR(std::accumulate(spike.begin(), spike.end(), 0.), 1, 1e-12);
        EXPECT_GE(*std::min_element(spike.begin(), spike.end()), -1e-15) << "apart from rounding";
      }
    }
  }
}

// Open sides reflect light: the field is half of a symmetric one in a periodic box of twice the length.
TEST(PlaneBlur, IsReflectedAtAnOpenSide) {
  const BoxGrid open = make_box(50, 48, 1, false), twice = make_box(100, 96, 1, true);
  std::vector<double> half(open.columns(), 0.), whole(twice.columns(), 0.);
  for (const auto& [i, j] : {std::pair(3, 5), std::pair(49, 20), std::pair(30, 47)}) {
    half[static_cast<std::size_t>(j * 50 + i)] = 1;
    for (const int x : {i, 99 - i})
      for (const int y : {j, 95 - j}) whole[static_cast<std::size_t>(y * 100 + x)] = 1;
  }
  blur_plane(half, open, 11.5);
  blur_plane(whole, twice, 11.5);
  for (int j = 0; j < 48; ++j)
    for (int i = 0; i < 50; ++i)
      EXPECT_NEAR(half[static_cast<std::size_t>(j * 50 + i)], whole[static_cast<std::size_t>(j * 100 + i)], 1e-14);
}

}  // namespace
}  // namespace cloudbow
