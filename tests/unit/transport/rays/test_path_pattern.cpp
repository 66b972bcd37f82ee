#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "transport/rays/path_pattern.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

BoxGrid unequal_box(int nx, int ny, bool periodic = true) {
  BoxGrid box = make_box(nx, ny, 0, periodic);
  box.dx_m = 30;
  box.dy_m = 20;
  box.z_edge_m = {100, 110, 135, 135.5, 300, 340};
  return box;
}

// All azimuths, steep and grazing, on the axes and along the diagonals of cells and of squares.
std::vector<Direction> pattern_directions() {
  std::vector<Direction> list;
  for (const double mu : {-1., -.999, -.5, -.02, .03, .577, 1.}) {
    for (const double azimuth : {0., 17., 45., 90., 133., 180., 200., 270., 315., 359.})
      list.push_back(travel_along(mu, azimuth));
  }
  for (const Direction& d : {Direction(1, 0, 1), Direction(0, -1, -1), Direction(3, 2, -1), Direction(-3, 2, 1)})
    list.push_back(d.normalized());
  return list;
}

struct ColumnSlope {
  double x;
  double y;
};

ColumnSlope columns_per_metre(const BoxGrid& box, const Direction& d) {
  return {d.x() / std::abs(d.z()) / box.dx_m, d.y() / std::abs(d.z()) / box.dy_m};
}

TEST(PathPattern, UniformLevelsHaveOneSegmentThatEndsInTheSameColumn) {
  BoxGrid box = unequal_box(7, 5);
  box.uniform = {0, 1, 0, 1, 1};
  const BoxGrid whole = unequal_box(7, 5);
  for (const Direction& travel : pattern_directions()) {
    const PathPattern pattern = make_path_pattern(box, travel, .3, .6, false, {0, box.nz()});
    const PathPattern full = make_path_pattern(whole, travel, .3, .6, false, {0, box.nz()});
    EXPECT_EQ(pattern.x, full.x);
    EXPECT_EQ(pattern.y, full.y);
    for (int step = 0; step < pattern.levels(); ++step) {
      EXPECT_EQ(pattern.shift_x(step + 1), full.shift_x(step + 1));
      EXPECT_EQ(pattern.shift_y(step + 1), full.shift_y(step + 1));
      if (box.is_uniform(pattern.level(step))) {
        EXPECT_EQ(pattern.level_begin[step + 1] - pattern.level_begin[step], 1U);
      }
    }
    EXPECT_LE(static_cast<double>(pattern.segments.size()), pattern_segments(box, travel, false, {0, box.nz()}));
  }
  EXPECT_LT(pattern_segments(box, pattern_directions()[30], false, {0, 5}),
            pattern_segments(whole, pattern_directions()[30], false, {0, 5}));
}

TEST(PathPattern, FollowsTheStraightLineThroughItsCells) {
  for (const bool periodic : {true, false}) {
    const BoxGrid box = unequal_box(7, 5, periodic);
    for (const Direction& travel : pattern_directions()) {
      const PathPattern pattern = make_path_pattern(box, travel, .3, .6, false, {0, box.nz()});
      const ColumnSlope slope = columns_per_metre(box, travel);
      ASSERT_EQ(pattern.levels(), box.nz());
      ASSERT_EQ(pattern.level_begin.size(), static_cast<std::size_t>(box.nz()) + 1);
      EXPECT_EQ(pattern.upward, travel.z() > 0);
      int shift_x = 0;
      int shift_y = 0;
      double height = 0;  // marched so far
      for (int step = 0; step < pattern.levels(); ++step) {
        const int k = pattern.level(step);
        const double thickness = box.thickness_m(k);
        EXPECT_DOUBLE_EQ(pattern.chord_m[step], thickness / std::abs(travel.z()));
        double done = 0;
        for (auto s = pattern.level_begin[step]; s < pattern.level_begin[step + 1]; ++s) {
          const Segment& segment = pattern.segments[s];
          ASSERT_GE(segment.fraction, 0);
          // One face at a time, and the one that `entry` names.
          const int moved_x = segment.shift_x - shift_x;
          const int moved_y = segment.shift_y - shift_y;
          EXPECT_EQ(moved_x, (segment.entry == Entry::x_low) - (segment.entry == Entry::x_high));
          EXPECT_EQ(moved_y, (segment.entry == Entry::y_low) - (segment.entry == Entry::y_high));
          shift_x = segment.shift_x;
          shift_y = segment.shift_y;
          // The middle of the segment lies in its cell. A grazing ray is a thousand columns on, so 1e-9 is rounding.
          if (segment.fraction > 1e-9) {
            const double middle = height + (done + segment.fraction / 2) * thickness;
            EXPECT_NEAR(.3 + slope.x * middle, shift_x + .5, .5 + 1e-9);
            EXPECT_NEAR(.6 + slope.y * middle, shift_y + .5, .5 + 1e-9);
          }
          done += segment.fraction;
        }
        EXPECT_NEAR(done, 1, 1e-12);
        height += thickness;
        EXPECT_NEAR(pattern.x[step + 1], .3 + slope.x * height, 1e-9);
        EXPECT_NEAR(pattern.y[step + 1], .6 + slope.y * height, 1e-9);
      }
    }
  }
}

TEST(PathPattern, LinearSourcesKeepTheCellsMean) {
  // The chord-weighted mean of the location within the cell is zero (effect of a slope of the source on the cell's
  // emission). Ends of segments join. Both hold to rounding of locations up to 500 columns away.
  const BoxGrid box = unequal_box(7, 5);
  for (const Direction& travel : pattern_directions()) {
    const PathPattern pattern = make_path_pattern(box, travel, .3, .6, false, {0, box.nz()});
    const ColumnSlope slope = columns_per_metre(box, travel);
    for (int step = 0; step < pattern.levels(); ++step) {
      const double thickness = box.thickness_m(pattern.level(step));
      std::array<double, 3> mean{};
      for (auto s = pattern.level_begin[step]; s < pattern.level_begin[step + 1]; ++s) {
        const Segment& segment = pattern.segments[s];
        for (int axis = 0; axis < 3; ++axis)
          mean[axis] += segment.fraction * .5 * (segment.from[axis] + segment.to[axis]);
        EXPECT_NEAR(segment.to[0] - segment.from[0], slope.x * thickness * segment.fraction, 1e-9);
        EXPECT_NEAR(segment.to[1] - segment.from[1], slope.y * thickness * segment.fraction, 1e-9);
        EXPECT_NEAR(segment.to[2] - segment.from[2], (pattern.upward ? 1 : -1) * segment.fraction, 1e-9);
        if (s + 1 < pattern.level_begin[step + 1]) {
          const Segment& next = pattern.segments[s + 1];
          EXPECT_NEAR(segment.to[0] + segment.shift_x, next.from[0] + next.shift_x, 1e-9);
          EXPECT_NEAR(segment.to[1] + segment.shift_y, next.from[1] + next.shift_y, 1e-9);
          EXPECT_NEAR(segment.to[2], next.from[2], 1e-12);
        }
      }
      for (const double m : mean) EXPECT_NEAR(m, 0, 1e-12);
    }
  }
}

TEST(PathPattern, CentredExitEndsInTheMiddleOfAColumn) {
  const BoxGrid box = unequal_box(7, 5);
  for (const Direction& travel : pattern_directions()) {
    const StartFraction start = start_for_centred_exit(box, travel, false, {0, box.nz()});
    EXPECT_GE(start.x, 0);
    EXPECT_LT(start.x, 1);
    EXPECT_GE(start.y, 0);
    EXPECT_LT(start.y, 1);
    const PathPattern pattern = make_path_pattern(box, travel, start.x, start.y, false, {0, box.nz()});
    EXPECT_NEAR(pattern.x.back() - std::floor(pattern.x.back()), .5, 1e-9);
    EXPECT_NEAR(pattern.y.back() - std::floor(pattern.y.back()), .5, 1e-9);
  }
}

TEST(PathPattern, VerticalModeStaysInItsColumnOnSlantedChords) {
  const BoxGrid box = unequal_box(7, 5);
  for (const Direction& travel : pattern_directions()) {
    const PathPattern pattern = make_path_pattern(box, travel, .3, .6, true, {0, box.nz()});
    ASSERT_EQ(pattern.segments.size(), static_cast<std::size_t>(box.nz()));
    for (int step = 0; step < pattern.levels(); ++step) {
      EXPECT_EQ(pattern.segments[step].fraction, 1);
      EXPECT_EQ(pattern.segments[step].entry, Entry::none);
      EXPECT_EQ(pattern.segments[step].shift_x, 0);
      EXPECT_EQ(pattern.segments[step].shift_y, 0);
      EXPECT_DOUBLE_EQ(pattern.chord_m[step], box.thickness_m(pattern.level(step)) / std::abs(travel.z()));
    }
    EXPECT_EQ(pattern.x.back(), .3);
    EXPECT_EQ(pattern.y.back(), .6);
    const StartFraction start = start_for_centred_exit(box, travel, true, {0, box.nz()});
    EXPECT_EQ(start.x, .5);
    EXPECT_EQ(start.y, .5);
  }
}

TEST(PathPattern, OnePeriodicColumnIsNotCrossedAndAnOpenOneIs) {
  const Direction travel = Direction(3, 2, -1).normalized();
  for (const bool periodic : {true, false}) {
    const BoxGrid box = unequal_box(7, 1, periodic);
    const PathPattern pattern = make_path_pattern(box, travel, .3, .6, false, {0, box.nz()});
    const PathPattern wide = make_path_pattern(unequal_box(7, 5), travel, .3, .6, false, {0, box.nz()});
    EXPECT_EQ(pattern.x, wide.x);
    EXPECT_EQ(pattern.chord_m, wide.chord_m);
    if (periodic) {
      EXPECT_EQ(pattern.y, std::vector<double>(pattern.x.size(), .6));
      for (const Segment& s : pattern.segments) EXPECT_EQ(s.shift_y, 0);
    } else {
      EXPECT_EQ(pattern.y, wide.y);
      EXPECT_EQ(pattern.segments.size(), wide.segments.size());
    }
  }
}

TEST(PathPattern, LevelsInRangeAreCrossedInMarchingOrder) {
  const BoxGrid box = unequal_box(7, 5);
  for (const double mu : {-.4, .4}) {
    const PathPattern part = make_path_pattern(box, travel_along(mu, 30), .5, .5, false, {1, 4});
    ASSERT_EQ(part.levels(), 3);
    for (int step = 0; step < 3; ++step) {
      const int k = mu > 0 ? 1 + step : 3 - step;
      EXPECT_EQ(part.level(step), k);
      EXPECT_DOUBLE_EQ(part.chord_m[step], box.thickness_m(k) / .4);
    }
  }
  const PathPattern none = make_path_pattern(box, travel_along(.4, 30), .5, .5, false, {2, 2});
  EXPECT_EQ(none.levels(), 0);
  EXPECT_EQ(none.x.size(), 1U);
}

}  // namespace
}  // namespace cloudbow
