// The final gather between the ends, which marches forwards. Truth: the gather at the ends, and closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "gather_test_tools.hpp"
#include "transport/gather/gather.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

TEST_F(GatherFlux, BetweenBottomAndTopTheForwardMarchHasTheSameMeans) {
  // The same directions, backwards and forwards, on average over a periodic box: each does the other's crossings, with
  // uniform extinction and sources that differ.
  const BoxGrid box = unequal_box(true);
  Random random(1);
  std::vector<double> value(cells_of(box));
  for (double& v : value) v = 1 + .2 * random();
  const SourceScene scene(box, std::vector<float>(cells_of(box), .004F), value, 5, 3);
  for (const bool upward : {true, false}) {
    const auto directions = gather_directions(128, upward, std::nullopt);
    const auto forward = gather_level_fluxes(scene.gather, inner_edges, upward, directions);
    for (std::size_t e = 0; e < inner_edges.size(); ++e) {
      const auto at = forward.begin() + static_cast<std::ptrdiff_t>(box.columns() * e);
      const std::vector<double> level(at, at + static_cast<std::ptrdiff_t>(box.columns()));
      const auto backward = gather_flux(scene.gather, inner_edges[e], upward, directions);
      EXPECT_NEAR(mean(level) / mean(backward), 1, 2e-5);  // fluxes of the forward march are float
    }
  }
}

TEST_F(GatherFlux, AnInterfaceIsTheSameWhateverOthersAreAskedFor) {
  const BoxGrid box = unequal_box(true);
  Random random(6);
  std::vector<double> value(cells_of(box));
  for (double& v : value) v = random();
  const SourceScene scene(box, random_extinction(box, .1, 2), value, 5, 3);
  for (const bool upward : {true, false}) {
    const auto directions = gather_directions(64, upward, std::nullopt);
    const auto all = gather_level_fluxes(scene.gather, inner_edges, upward, directions);
    const auto alone = gather_level_fluxes(scene.gather, std::array{4}, upward, directions);
    for (std::size_t c = 0; c < box.columns(); ++c) EXPECT_EQ(alone[c], all[3 * box.columns() + c]);
  }
}

// A blur is linear: sums that are blurred one by one differ by rounding alone, of some thirty additions in float.
TEST_F(GatherFlux, QuadrantsOneByOneAreThoseTogether) {
  const BoxGrid box = unequal_box(true);
  Random random(8);
  std::vector<double> value(cells_of(box));
  for (double& v : value) v = random();
  const SourceScene scene(box, random_extinction(box, .1, 3), value, 5, 3);
  for (const bool upward : {true, false}) {
    const auto directions = gather_directions(64, upward, std::nullopt);
    const auto together = gather_level_fluxes(scene.gather, inner_edges, upward, directions);
    const auto one_by_one = gather_level_fluxes(scene.gather, inner_edges, upward, directions, nullptr, 0.);
    EXPECT_NE(one_by_one, together);
    for (std::size_t c = 0; c < together.size(); ++c) EXPECT_NEAR(one_by_one[c] / together[c], 1, 3e-6);
  }
}

// Eight directions of a quadrant at a time keep five numbers per cell.
TEST_F(GatherFlux, MemoryIsThatOfTheQuadrantsThatAreMarchedAtOnce) {
  const BoxGrid box = unequal_box(true);
  constexpr std::size_t cells = 1000;
  constexpr std::size_t of_quadrant = 8 * 5 * cells * sizeof(float);
  const auto more = [&](int threads) {
    return level_gather_bytes<float>(box, cells, inner_edges, 64, threads) -
           level_gather_bytes<float>(box, 0, inner_edges, 64, threads);
  };
  EXPECT_EQ(more(1), of_quadrant);
  EXPECT_EQ(more(3), 3 * of_quadrant);
  EXPECT_EQ(more(64), 4 * of_quadrant);
}

TEST_F(GatherFlux, InVacuumAboveCloudTheForwardMarchIsAsSmoothAsTheEnds) {
  // Scattered bright cells in two levels, seen 18 and 28 levels above. The two methods differ in the starting points of
  // their rays, and by a half in the width of their blur. Without blur the error of the forward march is .11 to .12 of
  // the mean, twelve times as much.
  const BoxGrid box = make_box(24, 20, 30);
  Random random(9);
  std::vector<float> extinction(cells_of(box), 0.F);
  for (std::size_t c = 0; c < 2 * box.columns(); ++c) extinction[c] = random() < .1 ? .1F : 0.F;
  const std::vector<double> bright(cells_of(box), 1.);
  const SourceScene scene(box, extinction, bright, 0, 0);
  const auto directions = gather_directions(128, true, std::nullopt);
  const auto spread = [](const std::vector<double>& flux) {
    const double middle = mean(flux);
    double square = 0;
    for (const double f : flux) square += (f - middle) * (f - middle);
    return std::sqrt(square / static_cast<double>(flux.size())) / middle;
  };
  const std::array edges{20, 29};
  const auto levels = gather_level_fluxes(scene.gather, edges, true, directions);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto at = levels.begin() + static_cast<std::ptrdiff_t>(box.columns() * e);
    const std::vector<double> forward(at, at + static_cast<std::ptrdiff_t>(box.columns()));
    const auto backward = gather_flux(scene.gather, edges[e], true, directions);
    EXPECT_LT(spread(forward), 3 * spread(backward)) << edges[e];
    EXPECT_NEAR(mean(forward) / mean(backward), 1, 1e-3) << edges[e];
  }
}

// Truth: the same matter and light in two blocks per level. Rays cross these one by one.
TEST_F(GatherFlux, AirInOneBlockIsThatInTwo) {
  BoxGrid box = make_box(8, 6, 0);
  box.dx_m = box.dy_m = 30;
  box.z_edge_m = {0, 10, 35, 36, 80, 120, 150, 1000};
  std::vector<float> cloud = random_extinction(box, .1, 5);
  for (std::size_t c = 0; c < cloud.size(); ++c) {
    const std::size_t k = c / box.columns();
    if (k < 2 || k > 4 || c % 5 != 0) cloud[c] = 0;
  }
  for (const double reference : {0., .7}) {
    const Layers layers{{1e-3, 2e-3, 0, 1e-3, 3e-3, 1e-4, 0}, {1e-3, 1e-3, 1e-3, 0, 3e-3, 1e-2, 0}};
    const auto fluxes = [&](int block) {
      const OpticalGrid grid = grid_in_blocks(box, cloud, layers, block);
      const Cells<double> cells = make_cells<double>(grid, std::vector<double>{0., 0.}, false);
      DirectionalSource<double> source{
          ControlPoints(12), AngularField<double>(12, cells.size()), -Direction::UnitZ(), {}};
      for_each_place(cells.rows, [&](std::uint32_t cell, std::size_t place) {
        const std::size_t k = place / box.columns();
        const bool of_cloud = cells.rows.places_of(cell) == 1;
        for (int m = 0; m < 12; ++m)
          source.at_points.row(m)[cell] =
              of_cloud ? 1 + .5 * std::sin(static_cast<double>(place + m)) : .2 + .1 * static_cast<double>(k);
      });
      GroundRadiance<double> ground{{}, AngularField<double>(1, box.columns()), {}};
      for (std::size_t c = 0; c < box.columns(); ++c) ground.at_points.row(0)[c] = 1 + .1 * static_cast<double>(c % 7);
      const GatherScene<double> scene{.box = grid.box,
                                      .cells = cells,
                                      .source = &source,
                                      .sky_radiance = .5,
                                      .ground = &ground,
                                      .reference = reference,
                                      .linear_source = false};
      std::vector<double> all;
      for (const bool upward : {false, true}) {
        const auto directions = gather_directions(48, upward, std::nullopt);
        const auto end = gather_flux(scene, upward ? box.nz() : 0, upward, directions);
        all.insert(all.end(), end.begin(), end.end());
        const auto inner = gather_level_fluxes(scene, std::array{1, 2, 3, 4, 5, 6}, upward, directions);
        all.insert(all.end(), inner.begin(), inner.end());
      }
      return all;
    };
    const auto one = fluxes(0), two = fluxes(4);
    ASSERT_EQ(one.size(), two.size());
    // Fluxes of some W m-2; those between the ends are floats.
    for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(one[i], two[i], 2e-6) << i << " of " << one.size();
  }
}

}  // namespace
}  // namespace cloudbow
