// The source in any direction. Truth: the terms of its sum.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "gather_test_tools.hpp"
#include "transport/gather/gather.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

TEST(DirectionalSource, AddsTheBeamsOwnPhaseFunctionToThePoints) {
  // Linear between points, so constants are kept; the first order follows its phase function exactly.
  const BoxGrid box = make_box(2, 1, 1);
  SourceScene scene(box, {1.F, 1.F}, {3., 4.}, 0, 0);
  scene.source.sun_travel = travel_along(-.5, 37);
  scene.source.first_order.push_back({PhaseFunction::henyey_greenstein(.7), {.5, 2.}});
  for (const Direction& d : {travel_along(-.5, 37), travel_along(.3, 200), travel_along(-.9, 100)}) {
    std::vector<double> source(2);
    scene.source.query(d, source.data());
    const double c = d.dot(scene.source.sun_travel);
    const double phase = (1 - .49) / std::pow(1.49 - 1.4 * c, 1.5);
    EXPECT_NEAR(source[0], 3 + .5 * phase, 1e-12);
    EXPECT_NEAR(source[1], 4 + 2 * phase, 1e-12);
  }
}

}  // namespace
}  // namespace cloudbow
