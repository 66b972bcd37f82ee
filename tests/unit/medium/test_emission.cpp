// Emission of the cells of a grid. Truth: closed forms for temperatures linear in height, and a search through dense
// arrays in place of row spans.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "../near_with_report.hpp"
#include "cloudbow/medium/emission.hpp"
#include "cloudbow/optics/planck.hpp"

namespace cloudbow {
namespace {

using testing::Each;
using testing::SizeIs;

constexpr double float_rounding = 1e-7;  // relative

double cube(double kelvin) { return kelvin * kelvin * kelvin; }
double air_at(double z) { return 300 - .01 * z; }

/// 4 x 3 x 4 voxels of 10 x 20 x 30 m from (-20, 40, 60). In column (3, 2) only one voxel is active.
constexpr std::array<int, 3> cells{4, 3, 4};
constexpr std::array<double, 3> size_m{10, 20, 30}, min_m{-20, 40, 60};

std::size_t at(int i, int j, int k) { return static_cast<std::size_t>((k * cells[1] + j) * cells[0] + i); }
bool is_active(int i, int j, int k) {
  if (i < 0 || j < 0 || k < 0 || i >= cells[0] || j >= cells[1] || k >= cells[2]) return false;
  return i == 3 && j == 2 ? k == 2 : (i + 2 * j + k) % 4 != 0;
}
double voxel_kelvin(int i, int j, int k) { return 270 + 3 * i - 2 * j - 1.5 * k * k; }

struct WarmCloud {
  CloudField field;
  VoxelTemperatures kelvin;
};

WarmCloud warm_cloud() {
  std::vector<float> dense(48, 0.F);
  VoxelTemperatures kelvin;
  for (int k = 0; k < cells[2]; ++k) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int i = 0; i < cells[0]; ++i) {
        if (!is_active(i, j, k)) continue;
        dense[at(i, j, k)] = .01F;
        kelvin.push_back(static_cast<float>(voxel_kelvin(i, j, k)));
      }
    }
  }
  return {make_cloud_field(cells, size_m, min_m, dense, "extinction"), kelvin};
}

constexpr std::array<double, 3> domain_min{-50, 0, 0}, domain_max{40, 120, 400};

/// The cloud in a larger domain, with levels that cut its voxels.
OpticalGrid grid_of(const CloudField& cloud, const std::vector<Layer>& layers, AirCells air) {
  LevelOptions options;
  options.air = air;
  options.edges_m = {70, 97, 100, 130, 300};
  return make_optical_grid(&cloud, {}, layers, domain_min, domain_max, true, 2, {0, 0}, options);
}

const std::vector<Layer> no_layers;
const std::vector<Layer> two_layers{{0, 140, .1, .5, 1}, {200, 350, .2, 0, 1}};

struct Case {
  const std::vector<Layer>& layers;
  AirCells air;
};

class Emission : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Grids, Emission,
                         testing::Values(Case{no_layers, AirCells::of_voxels}, Case{two_layers, AirCells::of_voxels},
                                         Case{two_layers, AirCells::in_blocks}));

TEST_P(Emission, IsTheSameEverywhereInIsothermalMatter) {
  const WarmCloud cloud = warm_cloud();
  OpticalGrid grid = grid_of(cloud.field, GetParam().layers, GetParam().air);
  EXPECT_FALSE(grid.emits());
  const VoxelTemperatures same(cloud.kelvin.size(), 280.F);
  const PlanckFunction planck = PlanckFunction::over({8, 12});
  set_emission(
      grid, [](double) { return 280; }, planck, &cloud.field, &same);
  EXPECT_TRUE(grid.emits());
  EXPECT_THAT(grid.planck, SizeIs(grid.active_cells()));
  EXPECT_THAT(grid.planck, Each(static_cast<float>(planck(280))));
  EXPECT_THAT(grid.planck_step, Each(0.F));
  EXPECT_THAT(grid.layer_planck, SizeIs(grid.box.nz()));
  EXPECT_THAT(grid.layer_planck, Each(testing::DoubleEq(planck(280))));
  EXPECT_THAT(grid.layer_planck_step, Each(0.));
}

/// Mean and step of T^3 in closed form, for a linear temperature.
void expect_cube(double mean, double step, double bottom_kelvin, double top_kelvin) {
  const double sum = bottom_kelvin + top_kelvin, squares = bottom_kelvin * bottom_kelvin + top_kelvin * top_kelvin;
  EXPECT_NEAR(mean / (sum * squares / 4), 1, float_rounding);
  // The step is a difference of T^3.
  EXPECT_NEAR(step, cube(top_kelvin) - cube(bottom_kelvin), float_rounding * cube(top_kelvin));
}

TEST_P(Emission, WithoutTemperaturesOfVoxelsIsThatOfTheAir) {
  const WarmCloud cloud = warm_cloud();
  OpticalGrid grid = grid_of(cloud.field, GetParam().layers, GetParam().air);
  set_emission(grid, air_at, cube, &cloud.field);
  int places = 0;
  grid.for_each_place([&](int k, std::size_t, std::size_t cell) {
    ++places;
    expect_cube(grid.planck[cell], grid.planck_step[cell], air_at(grid.box.z_edge_m[k]),
                air_at(grid.box.z_edge_m[k + 1]));
  });
  EXPECT_GT(places, 30);
  for (int k = 0; k < grid.box.nz(); ++k)
    expect_cube(grid.layer_planck[k], grid.layer_planck_step[k], air_at(grid.box.z_edge_m[k]),
                air_at(grid.box.z_edge_m[k + 1]));
}

TEST_P(Emission, InVoxelsHasTheirTemperatureAndTheSlopeOfTheirNeighbours) {
  const WarmCloud cloud = warm_cloud();
  OpticalGrid grid = grid_of(cloud.field, GetParam().layers, GetParam().air);
  set_emission(grid, air_at, cube, &cloud.field, &cloud.kelvin);
  int in_voxels = 0, in_air = 0, centred = 0, one_sided = 0, alone = 0;
  grid.for_each_place([&](int level, std::size_t column, std::size_t cell) {
    const double bottom = grid.box.z_edge_m[level], top = grid.box.z_edge_m[level + 1], middle = (bottom + top) / 2;
    const int i = static_cast<int>(column) % grid.box.nx - 3, j = static_cast<int>(column) / grid.box.nx - 2;
    const int k = static_cast<int>(std::floor((middle - min_m[2]) / size_m[2]));
    if (!is_active(i, j, k)) {
      ++in_air;
      expect_cube(grid.planck[cell], grid.planck_step[cell], air_at(bottom), air_at(top));
      return;
    }
    ++in_voxels;
    const double here = voxel_kelvin(i, j, k), centre = min_m[2] + (k + .5) * size_m[2];
    double slope = -.01;
    if (is_active(i, j, k + 1) && is_active(i, j, k - 1)) {
      ++centred;
      slope = (voxel_kelvin(i, j, k + 1) - voxel_kelvin(i, j, k - 1)) / 60;
    } else if (is_active(i, j, k + 1)) {
      ++one_sided;
      slope = (voxel_kelvin(i, j, k + 1) - here) / 30;
    } else if (is_active(i, j, k - 1)) {
      ++one_sided;
      slope = (here - voxel_kelvin(i, j, k - 1)) / 30;
    } else {
      ++alone;
    }
    expect_cube(grid.planck[cell], grid.planck_step[cell], here + slope * (bottom - centre),
                here + slope * (top - centre));
  });
  // Levels cut three of the four planes: more cells than voxels.
  EXPECT_GT(in_voxels, static_cast<int>(cloud.kelvin.size()));
  EXPECT_EQ(in_air > 0, !GetParam().layers.empty());
  EXPECT_GT(centred, 0);
  EXPECT_GT(one_sided, 0);
  EXPECT_GT(alone, 0);
}

TEST(EmissionOfCells, IsNowhereNegative) {
  const CloudField cloud = make_cloud_field({1, 1, 1}, {10, 10, 100}, {0, 0, 0}, {.01F}, "extinction");
  OpticalGrid grid = make_optical_grid(&cloud, {}, {}, {0, 0, 0}, {10, 10, 100}, true, 1, {0}, {});
  // Nearly nothing at the bottom: the mean by Simpson's rule is a sixth of the step.
  set_emission(
      grid, [](double z) { return 10 + .9 * z; }, PlanckFunction::at(10.8));
  EXPECT_GT(grid.planck[0], 0);
  EXPECT_GE(grid.planck[0] - grid.planck_step[0] / 2, 0);
}

// -- Heights ----------------------------------------------------------------------------------------------------------

/// Largest distance of B from its chords, over the largest B.
double departure(const Atmosphere& air, const auto& planck, double bottom, double top, std::vector<double> heights) {
  heights.insert(heights.begin(), bottom);
  heights.push_back(top);
  const auto radiance = [&](double z) { return planck(air.temperature_at(z)); };
  double worst = 0, largest = 0;
  for (std::size_t n = 0; n + 1 < heights.size(); ++n) {
    EXPECT_LT(heights[n], heights[n + 1]);
    const double low = radiance(heights[n]), high = radiance(heights[n + 1]);
    for (double share = 0; share <= 1; share += 1. / 1024) {
      const double here = radiance(heights[n] + share * (heights[n + 1] - heights[n]));
      worst = std::max(worst, std::abs(here - (1 - share) * low - share * high));
      largest = std::max(largest, here);
    }
  }
  return worst / largest;
}

TEST(HeightsForPlanck, AreNoneIfTheRadianceIsLinear) {
  const Atmosphere isothermal{{0, 10000}, {1e5, 3e4}, {250, 250}, {}};
  EXPECT_THAT(heights_where_planck_is_linear(isothermal, cube, 0, 9000, 1e-6), SizeIs(0));
  const Atmosphere linear{{0, 3000, 10000}, {1e5, 7e4, 3e4}, {300, 270, 200}, {}};
  EXPECT_THAT(heights_where_planck_is_linear(
                  linear, [](double kelvin) { return kelvin; }, 0, 9000, 1e-6),
              SizeIs(0));
}

TEST(HeightsForPlanck, AreAsManyAsTheCurvatureNeeds) {
  const Atmosphere linear{{0, 10000}, {1e5, 3e4}, {300, 200}, {}};
  const auto fourth_power = [](double kelvin) { return std::pow(kelvin, 4); };
  for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5}) {
    const auto heights = heights_where_planck_is_linear(linear, fourth_power, 0, 10000, tolerance);
    EXPECT_LE(departure(linear, fourth_power, 0, 10000, heights), tolerance);
    // A chord over h departs by h^2 B'' / 8: levels = integral of sqrt(B'' / (8 tolerance B)) dz, in closed form.
    const double levels = std::sqrt(12. / (8 * tolerance)) * (1 - std::pow(2. / 3, 2)) / 2;
    // More of them: the last one may be short, and the steps end on points 5 or more to a level.
    EXPECT_LE(static_cast<double>(heights.size()), 1.25 * levels + 1) << tolerance;
  }
}

TEST(HeightsForPlanck, KeepTheToleranceInTheStandardAtmosphere) {
  const Atmosphere air = us_standard_1976();
  for (const PlanckFunction& planck :
       {PlanckFunction::at(10.8), PlanckFunction::at(15), PlanckFunction::over({8, 12})}) {
    for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
      const auto heights = heights_where_planck_is_linear(air, planck, 0, 30000, tolerance);
      EXPECT_LE(departure(air, planck, 0, 30000, heights), tolerance);
    }
    // Measured: 14, 11 and 14 levels.
    EXPECT_LT(heights_where_planck_is_linear(air, planck, 0, 30000, 1e-3).size(), 16);
  }
}

}  // namespace
}  // namespace cloudbow
