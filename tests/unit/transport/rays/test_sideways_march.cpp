#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "gather_test_tools.hpp"
#include "transport/rays/march.hpp"
#include "transport/rays/ordinate_path.hpp"
#include "transport/rays/sideways_march.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

BoxGrid even_box() {
  BoxGrid box = make_box(21, 23, 7, true);
  box.dx_m = 30;
  box.dy_m = 20;
  for (int e = 0; e <= 7; ++e) box.z_edge_m[e] = 100 + 25. * e;
  return box;
}

std::vector<Direction> slanted() {
  return {travel_along(-.6, 37),  travel_along(.6, 217),  travel_along(-.25, 100), travel_along(.3, 300),
          travel_along(.5, 90),   travel_along(-.45, 0),  travel_along(.4, 181),   Direction(3, 2, -1).normalized(),
          travel_along(-.2, 265), travel_along(.35, 135), travel_along(-.5, 315)};
}

// A march of one direction along x or y through a field, as the sweep makes it.
template <class Real>
struct Sideways {
  std::vector<Real> mean, leaving;
  std::vector<double> at_level;
  double left = 0;  // sum over the columns

  Sideways(const BoxGrid& box, const Cells<Real>& cells, const SidewaysPath& path, const std::vector<Real>& source,
           const std::vector<Real>& entering)
      : mean(cells.size() + lane_padding), leaving(box.columns()), at_level(box.nz() + 1) {
    const std::size_t n = cells.size();
    const TransposedCells<Real>& transposed = cells.transposed[path.axis];
    const bool along_x = path.axis == 0;
    const auto in_order = [&](const std::vector<Real>& of_cell) {
      std::vector<Real> result(n + lane_padding);
      for (std::size_t c = 0; c < n; ++c) result[c] = of_cell[along_x ? transposed.cell[c] : c];
      return result;
    };
    LinearSource<Real> linear;
    linear.resize(n);
    std::copy(source.begin(), source.end(), linear.value.begin());
    linear.make_gradient(cells);
    const std::vector<Real> value = in_order(linear.value), x = in_order(linear.gradient[0]),
                            y = in_order(linear.gradient[1]), z = in_order(linear.gradient[2]);
    const CellView<Real> view{along_x ? transposed.extinction.data() : cells.extinction.data(),
                              {along_x ? y.data() : x.data(), z.data(), along_x ? x.data() : y.data()}};
    // Planes by sheet and column: turned for the march along x.
    const auto transposed_plane = [&](const std::vector<Real>& plane, int nx, int ny) {
      std::vector<Real> result(plane.size());
      for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i)
          result[static_cast<std::size_t>(i) * ny + j] = plane[static_cast<std::size_t>(j) * nx + i];
      }
      return result;
    };
    const std::vector<Real> by_sheet = along_x ? transposed_plane(entering, box.nx, box.ny) : entering;
    SidewaysPlanes<Real> planes;
    planes.entering = by_sheet;
    planes.leaving = leaving;
    planes.at_level = at_level;
    std::vector<Real> in_sheets(n + lane_padding);
    SidewaysWorkspace<Real> work;
    march_sideways(path, transposed.sheets, transposed.gaps, view, value.data(), planes, {in_sheets.data(), {}}, work);
    for (std::size_t c = 0; c < n; ++c) mean[along_x ? transposed.cell[c] : c] = in_sheets[c];
    mean.resize(n);
    if (along_x) leaving = transposed_plane(leaving, box.ny, box.nx);
    left = planes.left;
  }
};

template <class Real, class Test>
void for_all_paths(const BoxGrid& box, const Test& test) {
  int paths = 0;
  for (const Direction& travel : slanted()) {
    for (const int axis : {0, 1}) {
      const auto path = make_sideways_path(box, travel, axis, {0, box.nz()});
      if (!path) continue;
      ++paths;
      SCOPED_TRACE(testing::Message() << "axis " << axis << ", travel " << travel.transpose());
      test(*path, travel);
    }
  }
  EXPECT_GT(paths, 15);
}

template <class Real>
class SidewaysMarchOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(SidewaysMarchOf, Precisions);

TYPED_TEST(SidewaysMarchOf, FurnaceStaysAtOneRadiance) {
  // Radiance and source 1 everywhere stay 1. Each of some hundred crossings may round by an ulp or two.
  constexpr double tolerance = 400 * static_cast<double>(std::numeric_limits<TypeParam>::epsilon());
  const BoxGrid box = even_box();
  for (const double largest : {1e-6, .1, 30., 1e5}) {
    const auto cells =
        make_cells<TypeParam>(make_grid(box, random_extinction(box, largest, 3), 1.), untruncated, false);
    for_all_paths<TypeParam>(box, [&](const SidewaysPath& path, const Direction&) {
      const Sideways<TypeParam> marched(box, cells, path, std::vector<TypeParam>(cells.size(), 1),
                                        std::vector<TypeParam>(box.columns(), 1));
      for (const TypeParam r : marched.leaving) ASSERT_NEAR(static_cast<double>(r), 1, tolerance);
      for (const TypeParam j : marched.mean) ASSERT_NEAR(static_cast<double>(j), 1, tolerance);
      for (const double sum : marched.at_level) ASSERT_NEAR(sum / static_cast<double>(box.columns()), 1, tolerance);
    });
  }
}

TYPED_TEST(SidewaysMarchOf, LightOfOneDirectionIsConserved) {
  // In + emitted = out + absorbed with uneven light from below or above and linear sources, to rounding. Every cell has
  // all of its chord, every part of the plane its ray. Light that changes rows and columns at the seam keeps its power.
  constexpr double tolerance = 400 * static_cast<double>(std::numeric_limits<TypeParam>::epsilon());
  const BoxGrid box = even_box();
  for (const double largest : {1e-3, .1, 3.}) {
    const auto cells =
        make_cells<TypeParam>(make_grid(box, random_extinction(box, largest, 4), 1.), untruncated, false);
    for_all_paths<TypeParam>(box, [&](const SidewaysPath& path, const Direction& travel) {
      Random random(5);
      std::vector<TypeParam> source(cells.size()), entering(box.columns());
      for (TypeParam& x : source) x = static_cast<TypeParam>(random());
      for (TypeParam& x : entering) x = static_cast<TypeParam>(random());
      const Sideways<TypeParam> marched(box, cells, path, source, entering);
      double in = std::accumulate(entering.begin(), entering.end(), 0.);
      double out = std::accumulate(marched.leaving.begin(), marched.leaving.end(), 0.);
      EXPECT_NEAR(marched.left / out, 1, tolerance);
      EXPECT_NEAR(marched.at_level[path.upward ? 0 : box.nz()] / in, 1, tolerance);
      EXPECT_NEAR(marched.at_level[path.upward ? box.nz() : 0] / out, 1, tolerance);
      for (std::size_t c = 0; c < cells.size(); ++c) {
        const double optical_path = static_cast<double>(cells.extinction[c]) * 25 / std::abs(travel.z());
        in += optical_path * static_cast<double>(source[c]);
        out += optical_path * static_cast<double>(marched.mean[c]);
      }
      EXPECT_NEAR(in / out, 1, tolerance);
      // A steep source may be slightly negative at the end of a segment.
      for (const TypeParam j : marched.mean) EXPECT_GE(j, -.01);
    });
  }
}

TEST(SidewaysMarch, UniformSlabHasTheClosedForm) {
  // A cell has only few rays, at their own heights. The error of its mean is thus the change of the light over up to
  // half a level. Over a level that averages out. The remaining error is that of the seam's interpolation between rows
  // one level apart. It is the curvature of the exponential: (path of a level)^2 / 8 of the remaining light, at each of
  // few seams.
  const BoxGrid box = even_box();
  constexpr double sigma = .0078125 / 4;
  std::vector<float> extinction(cells_of(box), static_cast<float>(sigma));
  extinction[0] *= 1 + 1e-6F;  // without any change along x and y there would be no cells for it
  const auto cells = make_cells<double>(make_grid(box, extinction, 1.), untruncated, false);
  for_all_paths<double>(box, [&](const SidewaysPath& path, const Direction& travel) {
    const Sideways<double> marched(box, cells, path, std::vector<double>(cells.size(), 2.),
                                   std::vector<double>(box.columns(), 5.));
    const double mu = std::abs(travel.z());
    const double of_level = sigma * 25 / mu;
    for (int k = 0; k < box.nz(); ++k) {
      const int before = travel.z() > 0 ? k : box.nz() - 1 - k;
      const double truth = 2 + 3 * std::exp(-before * of_level) * -std::expm1(-of_level) / of_level;
      double mean = 0;
      for (std::size_t c = k * box.columns(); c < (k + 1) * box.columns(); ++c) {
        EXPECT_NEAR(marched.mean[c], truth, .5 * 3 * of_level);
        mean += marched.mean[c] / static_cast<double>(box.columns());
      }
      EXPECT_NEAR(mean, truth, 3 * of_level * of_level / 4);
    }
    const double left = 2 + 3 * std::exp(-box.nz() * of_level);
    double mean = 0;
    for (const double r : marched.leaving) {
      EXPECT_NEAR(r, left, .1 * 3 * of_level);  // measured: .06
      mean += r / static_cast<double>(box.columns());
    }
    EXPECT_NEAR(mean, left, 3 * of_level * of_level / 4);
  });
}

TEST(SidewaysMarch, AgreesWithTheMarchAlongZInTheMean) {
  // Both are the mean over all rays of a field, which differ in their places in the cells alone.
  const BoxGrid box = even_box();
  const auto cells = make_cells<double>(make_grid(box, random_extinction(box, .02, 8), 1.), untruncated, false);
  std::vector<double> source;
  for (const double e : cells.extinction) source.push_back(std::sin(200 * e) + 1);
  source.resize(cells.size());
  for_all_paths<double>(box, [&](const SidewaysPath& path, const Direction& travel) {
    const Sideways<double> marched(box, cells, path, source, std::vector<double>(box.columns(), 1.));
    LinearSource<double> linear;
    linear.resize(cells.size());
    std::copy(source.begin(), source.end(), linear.value.begin());
    linear.make_gradient(cells);
    std::vector<double> mean(cells.size() + lane_padding), rays(box.columns() + lane_padding, 1.);
    const PathPattern pattern = make_path_pattern(box, travel, .5, .5, false, {0, box.nz()});
    march<double, true>(pattern, cells.rows, linear.view(cells), true, {}, linear.value.data(), rays.data(), true,
                        {mean.data(), {}}, [](int, const double*, auto&) {});
    const double along_z = std::accumulate(rays.begin(), rays.begin() + static_cast<std::ptrdiff_t>(box.columns()), 0.);
    const double sideways = std::accumulate(marched.leaving.begin(), marched.leaving.end(), 0.);
    EXPECT_NEAR(sideways / along_z, 1, .02);  // measured: .011 at most
    double difference = 0, size = 0;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      difference += std::pow(marched.mean[c] - mean[c], 2);
      size += mean[c] * mean[c];
    }
    EXPECT_LT(std::sqrt(difference / size), .15);  // measured: .11 at most
  });
}

TEST(OrdinatePaths, TakeTheShortestWay) {
  const BoxGrid box = even_box();
  const auto cells = make_cells<float>(make_grid(box, random_extinction(box, .05, 9), 1.), untruncated, false);
  const auto paths =
      make_ordinate_paths(box, cells, {travel_along(-1, 0), travel_along(.2, 8), travel_along(-.2, 80)}, false);
  EXPECT_TRUE(paths[0].sideways.empty());
  ASSERT_EQ(paths[1].sideways.size(), 1U);
  EXPECT_EQ(paths[1].sideways[0].axis, 0);
  ASSERT_EQ(paths[2].sideways.size(), 1U);
  EXPECT_EQ(paths[2].sideways[0].axis, 1);
  // A field that does not change along an axis keeps that: it is marched along z.
  std::vector<float> rows(cells_of(box));
  for (std::size_t c = 0; c < rows.size(); ++c) rows[c] = .01F * static_cast<float>(1 + c / 21 % 3);
  EXPECT_TRUE(make_cells<float>(make_grid(box, rows, 1.), untruncated, false).even_runs.empty());
  // Columns that exchange no light are marched along z, and so is a box with open sides.
  EXPECT_TRUE(
      make_ordinate_paths(box, make_cells<float>(make_grid(box, random_extinction(box, .1, 9), 1.), untruncated, true),
                          {travel_along(.2, 8)}, true)[0]
          .sideways.empty());
}

}  // namespace
}  // namespace cloudbow
