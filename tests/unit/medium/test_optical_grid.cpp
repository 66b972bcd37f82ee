// Levels and coefficients of the optical grid. Truth: the optical depths that went in, counted by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/optical_grid.hpp"

namespace cloudbow {
namespace {

constexpr std::array<double, 3> origin{0, 0, 0};

/// 4 x 3 x 5 cells of 10 x 20 x 30 m from z = 60 m, of which the lowest and the highest plane are empty.
CloudField small_cloud() {
  const std::array<int, 3> cells{4, 3, 5};
  std::vector<float> dense(60, 0.0f);
  for (int k = 1; k < 4; ++k) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 4; ++i) {
        if ((i + j + k) % 3 != 0) dense[(k * 3 + j) * 4 + i] = 0.001f * static_cast<float>(1 + i + 5 * j + 17 * k);
      }
    }
  }
  return make_cloud_field(cells, {10, 20, 30}, {0, 0, 60}, dense, "extinction");
}

/// Optical depth of each column, by absorption and scattering together.
std::vector<double> column_optical_depth(const OpticalGrid& grid) {
  std::vector<double> depth(grid.box.columns(), 0.0);
  for (int k = 0; k < grid.box.nz(); ++k) {
    for (int j = 0; j < grid.box.ny; ++j) {
      const std::size_t row = static_cast<std::size_t>(k) * grid.box.ny + j;
      for (std::uint32_t s = grid.row_begin[row]; s < grid.row_begin[row + 1]; ++s) {
        for (int n = 0; n < grid.spans[s].n; ++n) {
          const std::size_t cell = grid.spans[s].offset + static_cast<std::size_t>(n);
          double extinction = grid.absorption[cell];
          for (const auto& scattering : grid.scattering) extinction += scattering[cell];
          depth[static_cast<std::size_t>(j) * grid.box.nx + grid.spans[s].i + n] +=
              extinction * grid.box.thickness_m(k);
        }
      }
    }
  }
  return depth;
}

// The matter of small_cloud() in a layer from the ground to above it, and a thin layer above.
OpticalGrid cloud_in_layers(AirCells air, double depth) {
  const CloudField cloud = small_cloud();
  LevelOptions options;
  options.air = air;
  return make_optical_grid(&cloud, {}, {{0, 210, depth, 0.5, 1}, {210, 300, 0.01, 1, 1}}, origin, {40, 60, 300}, true,
                           2, {0, 0}, options);
}

TEST(OpticalGrid, LayersInBlocksAreTheSameMatter) {
  for (const double depth : {.01, 3.}) {
    const OpticalGrid own = cloud_in_layers(AirCells::of_voxels, depth);
    const OpticalGrid blocks = cloud_in_layers(AirCells::in_blocks, depth);
    EXPECT_TRUE(own.air.empty());
    ASSERT_EQ(blocks.air.size(), static_cast<std::size_t>(blocks.box.nz()));
    EXPECT_LT(blocks.active_cells(), own.active_cells());
    EXPECT_EQ(blocks.box.z_edge_m, own.box.z_edge_m);
    // Voxel by voxel.
    std::vector<double> expected(own.box.columns() * own.box.nz(), 0.), found = expected;
    own.for_each_place([&](int k, std::size_t column, std::size_t cell) {
      expected[k * own.box.columns() + column] = own.extinction(cell);
    });
    blocks.for_each_place([&](int k, std::size_t column, std::size_t cell) {
      EXPECT_GE(cell, blocks.first_cell(k));
      EXPECT_LT(cell, blocks.first_cell(k + 1));
      found[k * own.box.columns() + column] = blocks.extinction(cell);
    });
    EXPECT_EQ(found, expected);
    // Levels without voxels of the cloud and with one block are uniform. The cloud's planes are at 90 to 180 m.
    for (int k = 0; k < blocks.box.nz(); ++k) {
      const double middle = (blocks.box.z_edge_m[k] + blocks.box.z_edge_m[k + 1]) / 2;
      EXPECT_EQ(blocks.box.is_uniform(k), middle > 180 || (middle < 90 && blocks.air[k].count() == 1)) << k;
    }
  }
}

TEST(OpticalGrid, BlocksAreAsWideAsScatteringAllows) {
  // Error 5 % of depth times width over distance, up to 10 % of depth; .3 % are wanted.
  const auto columns = [](double depth, double distance_m) {
    const AirBlockWidth width = air_block_width(depth, distance_m, 50, 128);
    EXPECT_LE(width.error, .003);
    return width.columns;
  };
  EXPECT_EQ(columns(0, 1000), 0);
  EXPECT_EQ(columns(.029, 1000), 0) << "10 % of it whatever the width";
  EXPECT_EQ(columns(.05, 1000), 16) << "up to 1200 m";
  EXPECT_EQ(columns(.1, 1000), 8) << "up to 600 m";
  EXPECT_EQ(columns(.29, 1000), 4);
  EXPECT_EQ(columns(.31, 1000), 1) << "blocks do not pay";
  EXPECT_EQ(columns(.31, 2000), 4) << "from further away";
  EXPECT_EQ(air_block_width(.31, 2000, 50, 8).columns, 4);
  EXPECT_EQ(air_block_width(.1, 1000, 50, 128, .009).columns, 32) << "up to 1800 m for three times the error";
  EXPECT_DOUBLE_EQ(air_block_width(.1, 1000, 50, 128).error, .05 * .1 * .4);
  EXPECT_TRUE(cloud_in_layers(AirCells::automatic, 30).air.empty());
  EXPECT_EQ(cloud_in_layers(AirCells::in_blocks, 30).air[0].width_x, 4);
  EXPECT_EQ(cloud_in_layers(AirCells::automatic, .01).air[0].width_x, 4) << "a whole level";
}

OpticalGrid slab(double optical_depth, double forward_fraction = 0,
                 LevelOptions options = LevelOptions::layers_only()) {
  return make_optical_grid(nullptr, {}, {{0, 1000, optical_depth, 1.0, 0}}, origin, {1, 1, 1000}, true, 1,
                           {forward_fraction}, options);
}

TEST(OpticalGrid, VoxelFacesJoinLayerEdgesAndEmptyPlanesStayWhole) {
  const CloudField cloud = small_cloud();
  // The layer cuts the voxels of the plane 120 to 150 m; it is thin enough not to be cut outside the cloud.
  const OpticalGrid grid =
      make_optical_grid(&cloud, {}, {{40, 130, 0.009, 0.5, 1}}, origin, {40, 60, 300}, true, 2, {0, 0}, LevelOptions{});
  EXPECT_EQ(grid.box.z_edge_m, (std::vector<double>{0, 40, 90, 120, 130, 150, 180, 300}));
  EXPECT_EQ(grid.box.cloud.count, 3);
  EXPECT_EQ(grid.box.cloud.bottom_m, 90);
  EXPECT_EQ(grid.box.cloud.height_m, 30);
  EXPECT_EQ(grid.box.nx, 4);
  EXPECT_EQ(grid.box.ny, 3);
  EXPECT_DOUBLE_EQ(grid.box.dx_m, 10);
  EXPECT_DOUBLE_EQ(grid.box.dy_m, 20);
  // Cells: none below the layer and above the cloud, whole planes in the layer, the cloud's own elsewhere.
  const auto cells_on_level = [&](int k) {
    std::size_t cells = 0;
    for (std::uint32_t s = grid.row_begin[k * 3]; s < grid.row_begin[(k + 1) * 3]; ++s) cells += grid.spans[s].n;
    return cells;
  };
  EXPECT_EQ(cells_on_level(0), 0u);
  for (int k = 1; k <= 3; ++k) EXPECT_EQ(cells_on_level(k), 12u) << k;
  EXPECT_EQ(cells_on_level(4), 8u);
  EXPECT_EQ(cells_on_level(5), 8u);
  EXPECT_EQ(cells_on_level(6), 0u);
  // Below and above the layer's edge in the same voxel plane: the same cloud, with and without the layer's 1e-4 1/m.
  const RowSpan below = grid.spans[grid.row_begin[3 * 3]];
  const RowSpan above = grid.spans[grid.row_begin[4 * 3]];
  for (int n = 0; n < above.n; ++n) {
    const std::size_t cell_below = below.offset + static_cast<std::size_t>(above.i + n);
    const std::size_t cell_above = above.offset + static_cast<std::size_t>(n);
    EXPECT_EQ(grid.scattering[0][cell_below], grid.scattering[0][cell_above]);
    EXPECT_FLOAT_EQ(grid.scattering[1][cell_below], 0.5e-4f);
    EXPECT_FLOAT_EQ(grid.absorption[cell_below] - grid.absorption[cell_above], 0.5e-4f);
  }
}

TEST(OpticalGrid, ColumnsKeepTheirOpticalDepth) {
  const CloudField cloud = small_cloud();
  const std::vector<Layer> layers{{0, 300, 0.05, 1.0, 1}, {70, 131, 3.0, 0.9, 2}, {250, 300, 12.0, 0.3, 0}};
  CloudOptics optics;
  optics.extinction_per_value = 2.5;
  optics.single_scattering_albedo = 0.97;
  const OpticalGrid grid =
      make_optical_grid(&cloud, optics, layers, {-20, -20, 0}, {40, 60, 300}, false, 3, {0.2, 0, 0.4}, LevelOptions{});
  ASSERT_EQ(grid.box.nx, 6);
  ASSERT_EQ(grid.box.ny, 4);
  const std::vector<double> depth = column_optical_depth(grid);
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 6; ++i) {
      double expected = 15.05;
      for (int k = 1; k < 4; ++k) {
        const int ci = i - 2;
        const int cj = j - 1;
        if (ci < 0 || cj < 0 || (ci + cj + k) % 3 == 0) continue;
        expected += 30 * 2.5 * 0.001 * (1 + ci + 5 * cj + 17 * k);
      }
      // Coefficients are floats: 6e-8 relative each, and as much again in the densities.
      EXPECT_NEAR(depth[j * 6 + i], expected, 1e-6 * expected) << i << ' ' << j;
    }
  }
}

TEST(OpticalGrid, WeakAbsorptionKeepsItsDigits) {
  const CloudField cloud = small_cloud();
  CloudOptics optics;
  optics.single_scattering_albedo = 1 - std::ldexp(1.0, -40);
  const OpticalGrid grid =
      make_optical_grid(&cloud, optics, {}, {0, 0, 60}, {40, 60, 210}, true, 1, {0}, LevelOptions{});
  ASSERT_EQ(grid.active_cells(), cloud.active_voxels());
  for (std::size_t cell = 0; cell < grid.active_cells(); ++cell) {
    // 1 - ssa is a power of two: the product is exact.
    EXPECT_EQ(grid.absorption[cell], std::ldexp(cloud.value[cell], -40));
  }
}

TEST(OpticalGrid, AlbedoByVoxel) {
  const CloudField cloud = small_cloud();
  CloudOptics optics;
  for (std::size_t voxel = 0; voxel < cloud.active_voxels(); ++voxel) {
    optics.voxel_single_scattering_albedo.push_back(voxel % 2 == 0 ? 1.0f : 0.25f);
  }
  const OpticalGrid grid =
      make_optical_grid(&cloud, optics, {}, {0, 0, 60}, {40, 60, 210}, true, 1, {0}, LevelOptions{});
  for (std::size_t cell = 0; cell < grid.active_cells(); ++cell) {
    EXPECT_EQ(grid.absorption[cell], cell % 2 == 0 ? 0.0f : 0.75f * cloud.value[cell]);
    EXPECT_EQ(grid.scattering[0][cell], cell % 2 == 0 ? cloud.value[cell] : 0.25f * cloud.value[cell]);
  }
}

// Liquid in the voxels 0 and 1, ice in 1 and 2, of three; the ice has the second and third phase function by shares.
// All numbers are powers of two.
TEST(OpticalGrid, ConstituentsAddUpInAVoxel) {
  const std::array<double, 3> cell{10, 10, 10};
  const CloudField liquid = make_cloud_field({3, 1, 1}, cell, origin, {.5F, .25F, 0}, "");
  const CloudField ice = make_cloud_field({3, 1, 1}, cell, origin, {0, .125F, .0625F}, "");
  const CloudField all = make_cloud_field({3, 1, 1}, cell, origin, {1, 1, 1}, "");
  CloudOptics drops, crystals;
  drops.single_scattering_albedo = .75;
  drops.extinction_per_value = 2;
  crystals.voxel_single_scattering_albedo = {.5, .25};
  crystals.phase_function = 1;
  crystals.voxel_phase_function = {0, 0};
  crystals.voxel_next_share = {.25F, 0};
  const OpticalGrid grid = make_optical_grid({&all, {{&liquid, &drops}, {&ice, &crystals}}}, {{0, 10, 2.5, .5, 2}},
                                             origin, {30, 10, 10}, true, 3, {0, 0, 0}, LevelOptions{});
  ASSERT_EQ(grid.active_cells(), 3U);
  constexpr float layer = .125F;
  EXPECT_EQ(grid.absorption, (std::vector<float>{.25F + layer, .125F + .0625F + layer, .046875F + layer}));
  EXPECT_EQ(grid.scattering[0], (std::vector<float>{.75F, .375F, 0}));
  EXPECT_EQ(grid.scattering[1], (std::vector<float>{0, .046875F, .015625F}));
  EXPECT_EQ(grid.scattering[2], (std::vector<float>{layer, .015625F + layer, layer}));
}

// The same function of two constituents.
TEST(OpticalGrid, ConstituentsMayShareAPhaseFunction) {
  const CloudField cloud = small_cloud();
  CloudOptics third, rest;
  third.extinction_per_value = .25;
  third.single_scattering_albedo = .5;
  rest.extinction_per_value = .75;
  rest.single_scattering_albedo = .5;
  CloudOptics whole;
  whole.single_scattering_albedo = .5;
  const OpticalGrid parts = make_optical_grid({&cloud, {{&cloud, &third}, {&cloud, &rest}}}, {}, {0, 0, 60},
                                              {40, 60, 210}, true, 1, {0}, LevelOptions{});
  const OpticalGrid one = make_optical_grid(&cloud, whole, {}, {0, 0, 60}, {40, 60, 210}, true, 1, {0}, LevelOptions{});
  ASSERT_EQ(parts.active_cells(), one.active_cells());
  for (std::size_t cell = 0; cell < one.active_cells(); ++cell) {
    EXPECT_FLOAT_EQ(parts.absorption[cell], one.absorption[cell]);
    EXPECT_FLOAT_EQ(parts.scattering[0][cell], one.scattering[0][cell]);
  }
}

TEST(OpticalGrid, LayersOnlyIsTheLayersAsOneColumn) {
  const CloudField cloud = small_cloud();
  const OpticalGrid grid =
      make_optical_grid(&cloud, {}, {{40, 130, 0.9, 0.5, 1}}, origin, {40, 60, 300}, false, 2, {0, 0}, LevelOptions{});
  const OpticalGrid column = layers_only(grid);
  EXPECT_EQ(column.box.columns(), 1u);
  EXPECT_TRUE(column.box.periodic);
  EXPECT_EQ(column.box.z_edge_m, grid.box.z_edge_m);
  EXPECT_NEAR(column_optical_depth(column)[0], 0.9, 1e-6 * 0.9);  // float coefficients
  EXPECT_TRUE(std::all_of(column.scattering[0].begin(), column.scattering[0].end(), [](float s) { return s == 0; }));
  EXPECT_EQ(column.row_begin.size(), grid.box.z_edge_m.size());
}

TEST(OpticalGrid, GradedLevels) {
  for (const double depth : {1e-6, 0.01, 1.0, 8.0, 100.0, 1e4}) {
    const OpticalGrid grid = slab(depth);
    const int nz = grid.box.nz();
    EXPECT_GE(nz, 12) << depth;
    EXPECT_LE(nz, 700) << depth;  // 2 * (count at the edges + 49 of at most 1 + ln(5000/50)/0.02)
    EXPECT_NEAR(column_optical_depth(grid)[0], depth, 1e-6 * depth);
    std::vector<double> level(nz);
    for (int k = 0; k < nz; ++k) level[k] = grid.box.thickness_m(k) * depth / 1000;
    EXPECT_LE(level.front(), 0.0225) << depth;  // h grows by 1.2 across the first level
    for (int k = 0; k < nz; ++k) {
      EXPECT_NEAR(level[k], level[nz - 1 - k], 1e-9 * depth) << depth;  // the same from both edges
      EXPECT_LE(level[k], depth <= 100 ? 1.0 + 1e-9 : 0.02 * depth / 2 * 1.02) << depth;
    }
    // A level of length h at h(t) = h0 + 0.2 t: neighbours differ by exp(0.2) = 1.221 at most.
    for (int k = 1; k < nz; ++k) {
      EXPECT_LE(std::max(level[k] / level[k - 1], level[k - 1] / level[k]), 1.2215) << depth << ' ' << k;
    }
  }
}

TEST(OpticalGrid, LevelsAreNoThinnerThanHeightsResolve) {
  // An edge level of .02 in 1e20 would be 2e-19 m thick at a height of 1000 m.
  const OpticalGrid grid = slab(1e20);
  for (int k = 0; k < grid.box.nz(); ++k) ASSERT_GT(grid.box.thickness_m(k), 1e-12) << k;
  EXPECT_NEAR(column_optical_depth(grid)[0], 1e20, 1e14);
}

TEST(OpticalGrid, DeltaMCoarsensLevels) {
  // Half of the light is scattered straight on: tau 100 is cut like tau 50.
  EXPECT_EQ(slab(100, 0.5).box.nz(), slab(50, 0).box.nz());
}

TEST(OpticalGrid, SplittingALayerAddsEdgesButNoNewInterfaces) {
  const OpticalGrid whole = slab(40);
  const OpticalGrid split = make_optical_grid(nullptr, {}, {{0, 500, 20, 1.0, 0}, {500, 1000, 20, 1.0, 0}}, origin,
                                              {1, 1, 1000}, true, 1, {0}, LevelOptions::layers_only());
  EXPECT_NE(std::find(split.box.z_edge_m.begin(), split.box.z_edge_m.end(), 500.0), split.box.z_edge_m.end());
  EXPECT_LE(split.box.nz(), whole.box.nz() + 1);
  // Different optics at 500 m: levels get thin there.
  const OpticalGrid other = make_optical_grid(nullptr, {}, {{0, 500, 20, 1.0, 0}, {500, 1000, 20, 0.9, 0}}, origin,
                                              {1, 1, 1000}, true, 1, {0}, LevelOptions::layers_only());
  const auto& z = other.box.z_edge_m;
  const auto middle = std::find(z.begin(), z.end(), 500.0);
  ASSERT_NE(middle, z.end());
  EXPECT_LE((*(middle + 1) - *middle) * 20 / 500, 0.0225);
  EXPECT_LE((*middle - *(middle - 1)) * 20 / 500, 0.0225);
}

TEST(OpticalGrid, LevelsByHand) {
  LevelOptions options;
  options.layer_cells = 4;
  const OpticalGrid grid = make_optical_grid(nullptr, {}, {{100, 200, 5, 1.0, 0}, {150, 200, 1, 1.0, 0}}, origin,
                                             {1, 1, 300}, true, 1, {0}, options);
  EXPECT_EQ(grid.box.z_edge_m, (std::vector<double>{0, 100, 112.5, 125, 137.5, 150, 162.5, 175, 187.5, 200, 300}));
}

TEST(OpticalGrid, EdgesThatCoincideBecomeOne) {
  const CloudField cloud = small_cloud();
  const OpticalGrid grid = make_optical_grid(&cloud, {}, {{90 + 1e-8, 150 - 1e-8, 0.01, 1.0, 0}}, {0, 0, 60},
                                             {40, 60, 210}, true, 1, {0}, LevelOptions{});
  EXPECT_EQ(grid.box.z_edge_m, (std::vector<double>{60, 90, 120, 150, 180, 210}));
}

TEST(OpticalGrid, FinestLevelsOfSeveral) {
  EXPECT_EQ(finest_levels({{0, 10, 20}}), (std::vector<double>{0, 10, 20}));
  EXPECT_EQ(finest_levels({{0, 5, 10, 20}, {0, 10, 13, 16, 20}, {0, 4, 10, 15, 20}}),
            (std::vector<double>{0, 5, 10, 13, 16, 20}));
}

TEST(OpticalGrid, LevelsAsGiven) {
  LevelOptions options;
  options.levels_m = {0, 10, 100, 200, 300};
  const OpticalGrid grid =
      make_optical_grid(nullptr, {}, {{100, 200, 5, 1.0, 0}}, origin, {1, 1, 300}, true, 1, {0}, options);
  EXPECT_EQ(grid.box.z_edge_m, options.levels_m);
  ASSERT_EQ(grid.active_cells(), 1u);
  EXPECT_FLOAT_EQ(grid.scattering[0][0], 0.05f);
}

TEST(OpticalGrid, Errors) {
  const LevelOptions levels = LevelOptions::layers_only();
  EXPECT_THROW(make_optical_grid(nullptr, {}, {{0, 1200, 1, 1.0, 0}}, origin, {1, 1, 1000}, true, 1, {0}, levels),
               InputError);
  EXPECT_THROW(make_optical_grid(nullptr, {}, {{0, 1e-8, 1, 1.0, 0}}, origin, {1, 1, 1000}, true, 1, {0}, levels),
               InputError);
  // An extinction of 1e300 1/m, which 32 bits do not hold.
  EXPECT_THROW(make_optical_grid(nullptr, {}, {{0, 1e-300, 1, 1.0, 0}}, origin, {1, 1, 1e-300}, true, 1, {0}, levels),
               InputError);
  const CloudField cloud = small_cloud();
  CloudOptics optics;
  optics.extinction_per_value = 1e300;
  EXPECT_THROW(make_optical_grid(&cloud, optics, {}, {0, 0, 60}, {40, 60, 210}, true, 1, {0}, levels), InputError);
}

}  // namespace
}  // namespace cloudbow
