#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "cloud_test_tools.hpp"
#include "cloudbow/medium/cloud_makers.hpp"
#include "maker_test_tools.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

/// FNV-1a of everything that makes the field.
std::uint64_t hash_of(const CloudField& field) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  const auto add = [&](std::uint32_t number) {
    for (int byte = 0; byte < 4; ++byte) hash = (hash ^ (number >> (8 * byte) & 0xffU)) * 0x100000001b3U;
  };
  for (const auto& span : field.spans) {
    add(static_cast<std::uint32_t>(span.i));
    add(static_cast<std::uint32_t>(span.n));
  }
  for (const auto begin : field.row_begin) add(begin);
  for (const float value : field.value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    add(bits);
  }
  return hash;
}

TEST(CloudMakers, SlabIsUniformAndHasItsOpticalDepth) {
  auto slab = options("slab", {4, 3, 10}, {100, 100, 20});
  slab.optical_depth = 7;
  const CloudField field = make_cloud(slab);
  EXPECT_EQ(field.quantity, "extinction");
  EXPECT_EQ(field.active_voxels(), 120U);
  for (const float value : field.value) EXPECT_FLOAT_EQ(value, 7.0F / 200);
  for (const double depth : column_depths(field)) EXPECT_NEAR(depth, 7, 7 * single_precision);
}

TEST(CloudMakers, SlabAboveItsBaseKeepsItsOpticalDepth) {
  auto slab = options("slab", {1, 1, 10}, {1, 1, 20});
  slab.base_m = 120;
  const CloudField field = make_cloud(slab);
  EXPECT_EQ(field.active_voxels(), 4U);
  EXPECT_EQ(to_dense(field)[5], 0);
  EXPECT_GT(to_dense(field)[6], 0);
  EXPECT_NEAR(column_depths(field)[0], 10, 10 * single_precision);
}

TEST(CloudMakers, StepHasTheOpticalDepthsOfTheIntercomparison) {
  const auto depths = column_depths(make_cloud(options("step", {32, 1, 16}, {15.625, 15.625, 15.625})));
  for (std::size_t i = 0; i < 32; ++i) EXPECT_NEAR(depths[i], i < 16 ? 2 : 18, 18 * single_precision);
}

TEST(CloudMakers, SphereHasItsVolumeAndItsOpticalDepthThroughTheCentre) {
  auto sphere = options("sphere", {40, 40, 41}, {10, 10, 10});
  sphere.optical_depth = 30;
  const CloudField field = make_cloud(sphere);
  const double radius = 195;
  const double extinction = 30 / (2 * radius);
  double mass = 0;
  for (const float value : field.value) mass += static_cast<double>(value) * 1000;
  // A cell's share is counted with 512 points; over the 4700 cells of the surface the errors all but cancel.
  EXPECT_NEAR(mass / (4.0 / 3 * 3.14159265358979 * radius * radius * radius * extinction), 1, 1e-3);
  const auto depths = column_depths(field);
  // The four central columns reach 7 m from the axis, at which the chord is shorter by 0.03 %. Its ends are accurate to
  // 1/8 of a cell.
  EXPECT_NEAR(depths[20 * 40 + 20], 30, 30 * 0.01);
  EXPECT_EQ(depths[0], 0);
}

TEST(CloudMakers, RandomCloudsHaveTheOpticalDepthAskedFor) {
  for (const std::string kind : {"cumulus", "stratocumulus"}) {
    auto cloud = options(kind, {64, 48, 32});
    cloud.optical_depth = 12.5;
    EXPECT_NEAR(cloudy_mean(column_depths(make_cloud(cloud))), 12.5, 12.5 * value_rounding) << kind;
  }
}

TEST(CloudMakers, RandomCloudsWrapAround) {
  for (const std::string kind : {"cumulus", "stratocumulus"}) {
    const auto depths = column_depths(make_cloud(options(kind, {96, 96, 32})));
    const auto difference = [&](int i1, int i2) {
      double sum = 0;
      for (int j = 0; j < 96; ++j)
        sum += std::abs(depths[static_cast<std::size_t>(j * 96 + i1)] - depths[static_cast<std::size_t>(j * 96 + i2)]);
      return sum;
    };
    double inside = 0;
    double far = 0;
    for (int i = 0; i < 95; ++i) {
      inside = std::max(inside, difference(i, i + 1));
      far += difference(i, (i + 48) % 96) / 95;
    }
    // Across the edge columns differ as neighbours do, not as distant columns do.
    EXPECT_LE(difference(95, 0), inside) << kind;
    EXPECT_LT(inside, far) << kind;
  }
}

TEST(CloudMakers, SeedsAreReproducibleEverywhere) {
  auto cumulus = options("cumulus", {32, 32, 24});
  auto stratocumulus = options("stratocumulus", {32, 24, 16});
  // Recorded from this program, the same with g++ 12 and clang 16, optimised or not: scenes refer to seeds, so the
  // values must not change.
  EXPECT_EQ(hash_of(make_cloud(cumulus)), 11582486181029134887U);
  EXPECT_EQ(hash_of(make_cloud(stratocumulus)), 4313300673944728484U);
  cumulus.seed = 2;
  stratocumulus.seed = 2;
  EXPECT_EQ(hash_of(make_cloud(cumulus)), 2561871778166401161U);
  EXPECT_EQ(hash_of(make_cloud(stratocumulus)), 11246827413245865206U);
}

TEST(CloudMakers, EmptyCloudsAreToldAsSuch) {
  auto hidden = options("cumulus", {16, 16, 8});
  hidden.cover = 0.001;  // less than one of 256 columns
  EXPECT_THAT(message_of([&] { make_cloud(hidden); }), HasSubstr("the cumulus is empty"));
  auto thin = options("slab", {4, 4, 4});
  thin.optical_depth = 1e-300;  // below the range of 32 bits
  EXPECT_THAT(message_of([&] { make_cloud(thin); }), HasSubstr("the slab is empty"));
  EXPECT_THAT(message_of([&] {
                make_cloud(options("sphere", {16, 16, 8}, {1e-6, 100, 100}));
              }),
              HasSubstr("the sphere is empty"));
}

TEST(CloudMakers, VoxelsThatNoFileHoldsAreErrors) {
  for (const double size : {1e-320, 1e-300, 1e308}) {
    for (const auto& kind : cloud_maker_kinds()) {
      EXPECT_THAT(message_of([&] {
                    make_cloud(options(kind, {16, 16, 8}, {50, size, 50}));
                  }),
                  HasSubstr("voxel-size-m is out of range"))
          << kind << size;
    }
  }
  EXPECT_THAT(message_of([&] {
                make_cloud(options("cumulus", {16, 16, 8}, {50, 0.05, 50}));
              }),
              HasSubstr("within a factor of 500"));
  auto dense = options("slab", {4, 4, 4});
  dense.optical_depth = 1e300;
  EXPECT_THAT(message_of([&] { make_cloud(dense); }), HasSubstr("optical-depth is out of range"));
}

TEST(CloudMakers, NonsenseIsToldAsSuch) {
  const auto fails_with = [](CloudMakerOptions bad, const std::string& text) {
    EXPECT_THAT(message_of([&] { make_cloud(bad); }), HasSubstr(text));
  };
  fails_with(options("cirrus", {4, 4, 4}),
             "unknown kind (\"cirrus\" found, slab, step, sphere, cumulus, stratocumulus are allowed)");
  fails_with(options("slab", {4, 0, 4}), "cells is out of range (0 found");
  fails_with(options("slab", {100000, 100000, 100000}), "cells is out of range");
  fails_with(options("slab", {4, 4, 4}, {1, -1, 1}), "voxel-size-m is out of range (-1 found");
  fails_with(options("slab", {4, 4, 4}, {1, std::numeric_limits<double>::quiet_NaN(), 1}),
             "voxel-size-m is out of range (nan found");
  fails_with(options("step", {5, 1, 4}), "an even number along x");
  fails_with(options("cumulus", {8, 64, 32}), "8 x 64 x 32 found, at least 16 x 16 x 8");
  auto bad = options("slab", {4, 4, 4});
  bad.optical_depth = 0;
  fails_with(bad, "optical-depth is out of range (0 found");
  bad = options("slab", {4, 4, 4});
  bad.cover = 0.5;
  fails_with(bad, "cover does not belong to slab");
  bad = options("sphere", {4, 4, 4});
  bad.base_m = 10;
  fails_with(bad, "base-m does not belong to sphere");
  bad = options("stratocumulus", {16, 16, 16});
  bad.cover = 1.2;
  fails_with(bad, "cover is out of range (1.2 found");
  bad = options("stratocumulus", {16, 16, 16});
  bad.base_m = 400;
  fails_with(bad, "base-m is out of range (400 found, 0 <= base < 400 m is allowed)");
}

}  // namespace
}  // namespace cloudbow
