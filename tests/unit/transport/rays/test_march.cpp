#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "gather_test_tools.hpp"
#include "transport/rays/march.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

BoxGrid unequal_box(bool periodic) {
  BoxGrid box = make_box(7, 5, 0, periodic);
  box.dx_m = 30;
  box.dy_m = 20;
  box.z_edge_m = {0, 10, 35, 36, 80, 120, 130};
  return box;
}

std::vector<Direction> directions() {
  return {travel_along(-1, 0),    travel_along(-.6, 37), travel_along(.6, 217),           travel_along(-.1, 100),
          travel_along(.05, 300), travel_along(.7, 90),  Direction(3, 2, -1).normalized()};
}

// One march; the field that holds the source before and the mean radiance after.
template <class Real>
struct Marched {
  std::vector<Real> mean;
  std::vector<Real> rays;
  MarchTotals totals;
};

template <class Real>
Marched<Real> march_once(const BoxGrid& box, const Cells<Real>& cells, const Direction& travel,
                         std::vector<Real> source, std::vector<Real> rays, const std::vector<Real>& side = {}) {
  const PathPattern pattern = make_path_pattern(box, travel, .3, .6, false, {0, box.nz()});
  const std::size_t cell_count = source.size(), ray_count = rays.size();
  LinearSource<Real> linear;
  linear.resize(cell_count);
  std::copy(source.begin(), source.end(), linear.value.begin());
  linear.make_gradient(cells);
  Marched<Real> result{std::vector<Real>(cell_count + lane_padding, Real(0)), std::move(rays), {}};
  result.rays.resize(ray_count + lane_padding);
  result.totals = march<Real, true>(pattern, cells.rows, linear.view(cells), box.periodic, side, linear.value.data(),
                                    result.rays.data(), true, {result.mean.data(), {}}, [](int, const Real*, auto&) {});
  result.mean.resize(cell_count);
  result.rays.resize(ray_count);
  return result;
}

struct NoAir {
  void enter(std::size_t) { FAIL(); }
  void cross(std::size_t, int) { FAIL(); }
  void leave() { FAIL(); }
};
const auto no_air = [](const Segment&) { return NoAir(); };

TEST(CrossLevel, GivesEveryCellOneChordAndEveryRayOneLevel) {
  for (const bool periodic : {true, false}) {
    const BoxGrid box = unequal_box(periodic);
    const ActiveRows rows = active_rows(make_grid(box, random_extinction(box, 1, 1, true), 1.));
    for (const Direction& travel : directions()) {
      const PathPattern pattern = make_path_pattern(box, travel, .3, .6, false, {0, box.nz()});
      std::vector<double> of_cell(rows.size(), 0.);
      for (int step = 0; step < pattern.levels(); ++step) {
        std::vector<double> of_ray(box.columns(), 0.);
        cross_level(
            pattern, step, pattern.level(step), rows,
            [&](const Segment& segment) {
              return [&, fraction = segment.fraction](std::size_t ray, std::size_t cell, int n) {
                EXPECT_LE(n, lanes);
                for (int i = 0; i < n; ++i) {
                  of_cell[cell + i] += fraction;
                  of_ray[ray + i] += fraction;
                }
              };
            },
            no_air, [](const Segment&, double) {});
        for (const double f : of_ray) EXPECT_NEAR(f, 1, 1e-12);  // rounding of up to thirty segments
      }
      for (const double f : of_cell) EXPECT_NEAR(f, 1, 1e-12);
    }
  }
}

TEST(CrossLevel, VisitsActiveCellsOnly) {
  const BoxGrid box = unequal_box(true);
  const auto extinction = random_extinction(box, 1, 2);
  const ActiveRows rows = active_rows(make_grid(box, extinction, 1.));
  std::vector<double> of_cell(rows.size(), 0.);
  const PathPattern pattern = make_path_pattern(box, travel_along(-.1, 100), .3, .6, false, {0, box.nz()});
  for (int step = 0; step < pattern.levels(); ++step) {
    cross_level(
        pattern, step, pattern.level(step), rows,
        [&](const Segment& segment) {
          return [&, fraction = segment.fraction](std::size_t, std::size_t cell, int n) {
            for (int i = 0; i < n; ++i) of_cell.at(cell + i) += fraction;
          };
        },
        no_air, [](const Segment&, double) {});
  }
  EXPECT_EQ(rows.size(), static_cast<std::size_t>(
                             std::count_if(extinction.begin(), extinction.end(), [](float e) { return e > 0; })));
  for (const double f : of_cell) EXPECT_NEAR(f, 1, 1e-12);
}

template <class Real>
class MarchOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(MarchOf, Precisions);

TYPED_TEST(MarchOf, FurnaceStaysAtOneRadiance) {
  // Black-body enclosure: radiance and source 1 everywhere stay 1, whatever is between. Each of some hundred
  // crossings may round by an ulp or two, in either direction.
  constexpr double tolerance = 40 * static_cast<double>(std::numeric_limits<TypeParam>::epsilon());
  for (const bool periodic : {true, false}) {
    for (const double largest : {1e-6, .1, 30., 1e5}) {
      const BoxGrid box = unequal_box(periodic);
      const auto cells =
          make_cells<TypeParam>(make_grid(box, random_extinction(box, largest, 3), 1.), untruncated, false);
      for (const Direction& travel : directions()) {
        const std::vector<TypeParam> side(periodic ? 0 : box.nz() + 1, TypeParam(1));
        const auto marched = march_once<TypeParam>(box, cells, travel, std::vector<TypeParam>(cells.size(), 1),
                                                   std::vector<TypeParam>(box.columns(), 1), side);
        for (const TypeParam r : marched.rays)
          ASSERT_NEAR(static_cast<double>(r), 1, tolerance) << largest << ' ' << travel.transpose();
        for (const TypeParam j : marched.mean)
          ASSERT_NEAR(static_cast<double>(j), 1, tolerance) << largest << ' ' << travel.transpose();
      }
    }
  }
}

TYPED_TEST(MarchOf, OpaqueCellShowsItsOwnSource) {
  // Beyond 5e6 too, the limit of the optical path.
  const BoxGrid box = make_box(1, 1, 1);
  for (const float extinction : {1e4F, 1e6F, 1e9F}) {
    const auto cells = make_cells<TypeParam>(make_grid(box, {extinction}, 1.), untruncated, false);
    const auto marched = march_once<TypeParam>(box, cells, travel_along(-.5, 10), {TypeParam(2)}, {TypeParam(5)});
    // Light that enters still contributes 1/t of the mean: at most 3/2e4.
    EXPECT_NEAR(static_cast<double>(marched.rays[0]), 2, 1e-3) << extinction;
    EXPECT_NEAR(static_cast<double>(marched.mean[0]), 2, 1e-3) << extinction;
  }
}

TYPED_TEST(MarchOf, LightOfOneDirectionIsConserved) {
  // In + emitted = out + absorbed, to rounding, with linear sources (limited ones among them) and open sides: the
  // algebra of the crossing is exact and every cell has all of its chord.
  constexpr double tolerance = 30 * static_cast<double>(std::numeric_limits<TypeParam>::epsilon());
  for (const bool periodic : {true, false}) {
    for (const double largest : {1e-3, .1, 3.}) {
      const BoxGrid box = unequal_box(periodic);
      const auto cells =
          make_cells<TypeParam>(make_grid(box, random_extinction(box, largest, 4), 1.), untruncated, false);
      for (const Direction& travel : directions()) {
        Random random(5);
        std::vector<TypeParam> source(cells.size()), rays(box.columns()), side(periodic ? 0 : box.nz() + 1);
        for (auto* v : {&source, &rays, &side}) {
          for (TypeParam& x : *v) x = static_cast<TypeParam>(random());
        }
        const auto marched = march_once<TypeParam>(box, cells, travel, source, rays, side);
        double in = std::accumulate(rays.begin(), rays.end(), marched.totals.entered_sides);
        double out = std::accumulate(marched.rays.begin(), marched.rays.end(), marched.totals.left_sides);
        const auto dense = dense_indices(cells.rows);
        for (std::size_t c = 0; c < cells.size(); ++c) {
          const double path = static_cast<double>(cells.extinction[c]) *
                              box.thickness_m(static_cast<int>(dense[c] / box.columns())) / std::abs(travel.z());
          in += path * static_cast<double>(source[c]);
          out += path * static_cast<double>(marched.mean[c]);
        }
        EXPECT_NEAR(in / out, 1, tolerance) << largest << ' ' << travel.transpose();
        if (!periodic && std::abs(travel.x()) > .1) {
          EXPECT_GT(marched.totals.left_sides, 0);
        }
        for (const TypeParam j : marched.mean) EXPECT_GE(j, 0);
      }
    }
  }
}

TYPED_TEST(MarchOf, ConstantSourceIsALinearOneWithoutSlopes) {
  // To rounding of some hundred crossings: the shorter path through the kernel sums fewer terms.
  constexpr double tolerance = 40 * static_cast<double>(std::numeric_limits<TypeParam>::epsilon());
  const BoxGrid box = unequal_box(true);
  const auto cells = make_cells<TypeParam>(make_grid(box, random_extinction(box, .1, 8), 1.), untruncated, false);
  Random random(9);
  std::vector<TypeParam> source(cells.size() + lane_padding);
  for (TypeParam& s : source) s = static_cast<TypeParam>(random());
  const std::vector<TypeParam> flat(cells.size() + lane_padding);
  for (const Direction& travel : directions()) {
    const PathPattern pattern = make_path_pattern(box, travel, .3, .6, false, {0, box.nz()});
    const auto marched = [&](const CellView<TypeParam>& view) {
      std::vector<TypeParam> mean(cells.size() + lane_padding), rays(box.columns() + lane_padding, TypeParam(1));
      march<TypeParam, true>(pattern, cells.rows, view, true, {}, source.data(), rays.data(), true, {mean.data(), {}},
                             [](int, const TypeParam*, auto&) {});
      mean.insert(mean.end(), rays.begin(), rays.end());
      return mean;
    };
    const auto linear = marched({cells.extinction.data(), flat, flat, flat});
    const auto constant = marched({cells.extinction.data(), {}});
    for (std::size_t c = 0; c < linear.size(); ++c)
      EXPECT_NEAR(static_cast<double>(constant[c]), static_cast<double>(linear[c]), tolerance);
  }
}

// Truth: the same march with arrays of all cells. Levels without cells, levels of air alone and levels of both.
TYPED_TEST(MarchOf, LevelsCanHaveArraysOfTheirOwn) {
  BoxGrid box = make_box(9, 7, 0);
  box.z_edge_m = {0, 1, 2, 3, 4, 9};
  std::vector<float> cloud = random_extinction(box, 3, 5);
  for (std::size_t c = 0; c < cloud.size(); ++c) {
    if (c / box.columns() != 2 || c % 5 != 0) cloud[c] = 0;
  }
  const Layers layers{{.01, .02, .02, 0, .01}, {.1, .1, .05, 0, .2}};
  const auto cells = make_cells<TypeParam>(grid_in_blocks(box, cloud, layers, 0), std::vector<double>{0., 0.}, false);
  Random random(4);
  std::array<std::vector<TypeParam>, 4> given;  // source, and slopes of the next three
  for (auto& of : given) {
    for (std::size_t c = 0; c < cells.size() + lane_padding; ++c) of.push_back(static_cast<TypeParam>(.3 * random()));
  }
  const auto& [source, x, y, z] = given;
  for (const Direction& travel : directions()) {
    const PathPattern pattern = make_path_pattern(box, travel, .3, .6, false, {0, box.nz()});
    for (const bool joins : {true, false}) {
      std::array<std::vector<TypeParam>, 4> whole, by_level;
      for (auto* sums : {&whole, &by_level}) {
        for (auto& sum : *sums) sum.resize(cells.size() + lane_padding);
      }
      const std::vector<TypeParam> start(box.columns() + lane_padding, TypeParam(2));
      std::vector<TypeParam> rays = start, rays_by_level = start;
      const auto no_use = [](int, const TypeParam*, auto&) {};
      march<TypeParam, true>(pattern, cells.rows, cells.view(cells.extinction, x, y, z), true, {}, source.data(),
                             rays.data(), joins, {whole[0].data(), {whole[1].data(), whole[2].data(), whole[3].data()}},
                             no_use);
      const MarchedCells<TypeParam> all{
          0,
          cells.view(cells.extinction, {}, {}, {}),
          source.data(),
          {by_level[0].data(), {by_level[1].data(), by_level[2].data(), by_level[3].data()}}};
      std::array<std::vector<TypeParam>, 3> own;
      march_by_level<TypeParam, true>(
          pattern, cells.rows, cells.extinction.data(), true, {},
          [&](int level) {
            const std::size_t first = cells.rows.level_cell[level], last = cells.rows.level_cell[level + 1];
            MarchedCells<TypeParam> marched = all.from(first);
            for (std::size_t axis = 0; axis < 3; ++axis) {
              own[axis].assign(last - first + lane_padding, TypeParam(99));
              std::copy(given[axis + 1].begin() + static_cast<std::ptrdiff_t>(first),
                        given[axis + 1].begin() + static_cast<std::ptrdiff_t>(last), own[axis].begin());
              marched.view.gradient[axis] = own[axis].data();
            }
            return marched;
          },
          rays_by_level.data(), joins, no_use);
      EXPECT_EQ(rays_by_level, rays);
      EXPECT_EQ(by_level, whole);
      EXPECT_NE(rays, start);
    }
  }
}

// Truth: the same march with joins = false, in which each ray crosses the air separately.
TYPED_TEST(MarchOf, RaysInAirAreThoseCrossedOneByOne) {
  // Float: differences of stored radiances lose up to a fifth of their digits.
  const double tolerance = std::is_same_v<TypeParam, float> ? 2e-6 : 1e-13;
  BoxGrid box = make_box(9, 7, 0);
  box.z_edge_m = {0, 1, 2, 3, 4, 9, 40, 41};
  std::vector<float> cloud = random_extinction(box, 3, 5);
  for (std::size_t c = 0; c < cloud.size(); ++c) {
    const std::size_t k = c / box.columns();
    if (k < 2 || k > 4 || c % 5 != 0) cloud[c] = 0;
  }
  for (const double opacity : {1., 100.}) {
    const Layers layers{{.01 * opacity, .02, .02, .01 * opacity, 0, 0, .01}, {.1, .1, .05 * opacity, .05, 0, 0, .2}};
    const auto cells = make_cells<TypeParam>(grid_in_blocks(box, cloud, layers, 0), std::vector<double>{0., 0.}, false);
    Random random(4);
    std::vector<TypeParam> source(cells.size() + lane_padding);
    std::array<std::vector<TypeParam>, 3> slope;
    for (TypeParam& s : source) s = static_cast<TypeParam>(random());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      slope[axis].resize(source.size());
      for (std::size_t c = 0; c < cells.size(); ++c) {
        const bool has_it = axis == 2 || cells.rows.places_of(c) == 1;  // air has a slope along z alone
        slope[axis][c] = has_it ? static_cast<TypeParam>(.6 * random() - .3) : TypeParam(0);
      }
    }
    for (const Direction& travel : directions()) {
      const PathPattern pattern = make_path_pattern(box, travel, .3, .6, false, {0, box.nz()});
      // All that a march leaves: sums over cells, rays, and means at the levels.
      const auto marched = [&](const CellView<TypeParam>& view, bool joins) {
        std::array<std::vector<TypeParam>, 4> sums;
        for (auto& sum : sums) sum.resize(cells.size() + lane_padding);
        std::vector<TypeParam> rays(box.columns() + lane_padding);
        for (std::size_t m = 0; m < box.columns(); ++m) rays[m] = static_cast<TypeParam>(m % 4);
        std::vector<double> all;
        march<TypeParam, true>(pattern, cells.rows, view, true, {}, source.data(), rays.data(), joins,
                               {sums[0].data(), {sums[1].data(), sums[2].data(), sums[3].data()}},
                               [&](int, const TypeParam* p, auto& air) {
                                 all.push_back(p != nullptr ? plane_sum(p, box.columns()) : air.sum());
                               });
        for (const auto& sum : sums) all.insert(all.end(), sum.begin(), sum.end());
        all.insert(all.end(), rays.begin(), rays.begin() + static_cast<std::ptrdiff_t>(box.columns()));
        return all;
      };
      for (const bool linear : {true, false}) {
        const CellView<TypeParam> view = linear ? cells.view(cells.extinction, slope[0], slope[1], slope[2])
                                                : cells.view(cells.extinction, {}, {}, {});
        const auto together = marched(view, true), one_by_one = marched(view, false);
        ASSERT_EQ(together.size(), one_by_one.size());
        for (std::size_t i = 0; i < together.size(); ++i)
          EXPECT_NEAR(together[i], one_by_one[i], tolerance * (1 + std::abs(one_by_one[i])))
              << i << " opacity " << opacity << " travel " << travel.transpose();
      }
    }
  }
}

TEST(March, UniformSlabHasTheClosedForm) {
  const BoxGrid box = unequal_box(true);
  const double depth = box.z_edge_m.back();
  const auto cells =
      make_cells<double>(make_grid(box, std::vector<float>(cells_of(box), .015625F), 1.), untruncated, false);
  for (const Direction& travel : directions()) {
    const auto marched = march_once<double>(box, cells, travel, std::vector<double>(cells.size(), 2.),
                                            std::vector<double>(box.columns(), 5.));
    const double mu = std::abs(travel.z());
    for (const double r : marched.rays) EXPECT_NEAR(r, 2 + 3 * std::exp(-.015625 * depth / mu), 1e-13);  // rounding
    const auto dense = dense_indices(cells.rows);
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const int k = static_cast<int>(dense[c] / box.columns());
      const double before = .015625 * (travel.z() > 0 ? box.z_edge_m[k] : depth - box.z_edge_m[k + 1]) / mu;
      const double path = .015625 * box.thickness_m(k) / mu;
      EXPECT_NEAR(marched.mean[c], 2 + 3 * std::exp(-before) * -std::expm1(-path) / path, 1e-13);
    }
  }
}

TEST(March, SourceThatIsLinearInHeightIsMarchedExactly) {
  // dI/ds = sigma (S - I) with S = 1 + b z has I = S - S' / sigma + const e^(-sigma s), S' the slope along the ray.
  // Differences over unequal levels, one-sided ones at both ends included, reproduce a linear source.
  const BoxGrid box = unequal_box(true);
  const double sigma = .015625;
  const double b = .01;
  const auto cells = make_cells<double>(
      make_grid(box, std::vector<float>(cells_of(box), static_cast<float>(sigma)), 1.), untruncated, false);
  std::vector<double> source;
  for (const std::uint32_t c : dense_indices(cells.rows)) {
    const auto k = c / box.columns();
    source.push_back(1 + b * .5 * (box.z_edge_m[k] + box.z_edge_m[k + 1]));
  }
  for (const Direction& travel : directions()) {
    const auto marched = march_once<double>(box, cells, travel, source, std::vector<double>(box.columns(), 5.));
    const double depth = box.z_edge_m.back();
    const double first = travel.z() > 0 ? 1 : 1 + b * depth;
    const double last = travel.z() > 0 ? 1 + b * depth : 1;
    const double lag = b * travel.z() / sigma;
    const double truth = last - lag + (5 - first + lag) * std::exp(-sigma * depth / std::abs(travel.z()));
    for (const double r : marched.rays) EXPECT_NEAR(r, truth, 1e-12);  // rounding
  }
}

TEST(March, CyclicShiftOfAPeriodicFieldShiftsTheAnswer) {
  // The same light at other locations: only the breaks of runs of cells at the edge differ, hence rounding (1e-14 of
  // 1).
  const BoxGrid box = unequal_box(true);
  const auto extinction = random_extinction(box, .1, 6);
  const auto moved = [&](const std::vector<float>& field, int by_x, int by_y) {
    std::vector<float> result(field.size());
    for (std::size_t c = 0; c < field.size(); ++c) {
      const std::size_t i = (c % 7 + by_x) % 7;
      const std::size_t j = (c / 7 % 5 + by_y) % 5;
      result[(c / 35 * 5 + j) * 7 + i] = field[c];
    }
    return result;
  };
  // The source is a function of the extinction, so that it moves along.
  const auto mean_radiance = [&](const std::vector<float>& field, const Direction& travel) {
    const auto cells = make_cells<double>(make_grid(box, field, 1.), untruncated, false);
    std::vector<double> source;
    for (const double e : cells.extinction) source.push_back(std::sin(200 * e) + 1);
    const auto marched = march_once<double>(box, cells, travel, source, std::vector<double>(box.columns(), 1.));
    std::vector<double> dense(cells_of(box), 0.);
    const auto index = dense_indices(cells.rows);
    for (std::size_t c = 0; c < cells.size(); ++c) dense[index[c]] = marched.mean[c];
    return dense;
  };
  for (const Direction& travel : directions()) {
    const auto here = mean_radiance(extinction, travel);
    for (const auto& [by_x, by_y] : {std::pair(3, 0), std::pair(0, 2), std::pair(6, 4)}) {
      const auto there = mean_radiance(moved(extinction, by_x, by_y), travel);
      for (std::size_t c = 0; c < here.size(); ++c) {
        EXPECT_NEAR(there[(c / 35 * 5 + (c / 7 % 5 + by_y) % 5) * 7 + (c % 7 + by_x) % 7], here[c], 1e-14);
      }
    }
  }
}

TEST(SourceGradient, KeepsTheSourcePositiveInTheCell) {
  const BoxGrid box = make_box(4, 4, 4);
  const auto cells = make_cells<double>(make_grid(box, std::vector<float>(64, 1.F), 1.), untruncated, false);
  Random random(7);
  std::vector<double> source(64), x(64), y(64), z(64);
  for (double& s : source) s = std::pow(random(), 8);  // contrasts that linear extrapolation would make negative
  source_gradient(cells, 0, 64, source.data(), x.data(), y.data(), z.data());
  int limited = 0;
  for (std::size_t c = 0; c < 64; ++c) {
    const double swing = .5 * (std::abs(x[c]) + std::abs(y[c]) + std::abs(z[c]));
    EXPECT_LE(swing, 1 + 1e-14);  // rounding
    limited += swing > 1 - 1e-14;
  }
  EXPECT_GT(limited, 10);
}

TEST(SpreadOnColumns, SharesOutAllOfEachRay) {
  for (const bool periodic : {true, false}) {
    for (const double width : {1., .25}) {
      for (const auto& [x, y] :
           {std::pair(.5, .5), std::pair(3.2, -7.9), std::pair(-.05, 2.), std::pair(100.999, .01)}) {
        std::vector<double> of_ray(7 * 5, 0.), of_column(7 * 5, 0.);
        spread_on_columns(x, y, width, 7, 5, periodic, [&](std::size_t column, std::size_t ray, int n, double weight) {
          EXPECT_GT(weight, 0);
          for (int i = 0; i < n; ++i) {
            of_ray[ray + i] += weight;
            of_column[column + i] += weight;
          }
        });
        // Overlaps below 1e-9 of a ray are dropped. Across open sides nothing is shared, and columns are full all the
        // same: only in the middle does each ray count for one.
        for (int r = 0; r < 7 * 5; ++r) {
          const int i = wrapped(r % 7 + static_cast<int>(std::floor(x)), 7);
          const int j = wrapped(r / 7 + static_cast<int>(std::floor(y)), 5);
          if (!periodic && (i == 0 || i == 6 || j == 0 || j == 4)) continue;
          EXPECT_NEAR(of_ray[r], 1, 4e-9);
        }
        for (const double w : of_column) EXPECT_NEAR(w, 1, 4e-9);
      }
    }
  }
}

TEST(SpreadOnColumns, KeepsTheMeanPlaceOfARayOneColumnWide) {
  // The ray of column (2, 1) starts at its place .3, .8 there; overlap is linear in the place.
  double mean_x = 0;
  double mean_y = 0;
  spread_on_columns(.3 + 1, .8 + 2, 1., 7, 5, true, [&](std::size_t column, std::size_t ray, int n, double weight) {
    const std::size_t followed = 1 * 7 + 2;
    if (ray > followed || ray + n <= followed) return;
    column += followed - ray;
    mean_x += weight * (static_cast<double>(column % 7) + .5);
    mean_y += weight * (static_cast<double>(column / 7) + .5);
  });
  EXPECT_NEAR(mean_x, 2 + 1.3, 1e-12);
  EXPECT_NEAR(mean_y, 1 + 2.8, 1e-12);
}

TEST(SpreadOnColumns, LeavesOnePeriodicColumnWhole) {
  int calls = 0;
  spread_on_columns(17.3, .5, 1., 1, 1, true, [&](std::size_t column, std::size_t ray, int n, double weight) {
    ++calls;
    EXPECT_EQ(n, 1);
    EXPECT_EQ(column, 0U);
    EXPECT_EQ(ray, 0U);
    EXPECT_EQ(weight, 1);
  });
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace cloudbow
