#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "transport/gather/gather.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::array<double, 1> untruncated{0.};

template <class Function>
double cosine_weighted(const std::vector<GatherDirection>& set, const Function& f) {
  double sum = 0;
  for (const auto& d : set) sum += d.weight * std::abs(d.travel.z()) * f(d.travel);
  return sum;
}

TEST(GatherDirections, SpiralHasTheCosineWeightedMeans) {
  // Midpoints in mu^2 and golden-section azimuths: low-discrepancy points, off by a few 1/n (512).
  for (const bool upward : {false, true}) {
    const auto set = gather_directions(512, upward, std::nullopt);
    ASSERT_EQ(set.size(), 512U);
    for (const auto& d : set) {
      EXPECT_NEAR(d.travel.norm(), 1, 1e-14);
      EXPECT_EQ(d.travel.z() > 0, upward);
    }
    EXPECT_NEAR(cosine_weighted(set, [](const Direction&) { return 1.; }), pi, 1e-12);
    EXPECT_NEAR(cosine_weighted(set, [](const Direction& d) { return std::abs(d.z()); }), 2 * pi / 3, 1e-3);
    EXPECT_NEAR(cosine_weighted(set, [](const Direction& d) { return d.z() * d.z(); }), pi / 2, 1e-3);
    EXPECT_NEAR(cosine_weighted(set, [](const Direction& d) { return d.x() * d.x(); }), pi / 4, 1e-2);
    EXPECT_NEAR(cosine_weighted(set, [](const Direction& d) { return d.x(); }), 0, 1e-2);
    EXPECT_NEAR(cosine_weighted(set, [](const Direction& d) { return d.x() * d.y(); }), 0, 1e-2);
  }
}

TEST(GatherDirections, WithASunTheMixtureStillHasThem) {
  for (const double mu0 : {1., .5, .2}) {
    const Direction sun = travel_along(-mu0, 37);
    const auto set = gather_directions(512, false, sun);
    EXPECT_GT(set.size(), 560U);
    EXPECT_LE(set.size(), 640U);
    for (const auto& d : set) EXPECT_LT(d.travel.z(), 0);
    // Two independent point sets: 1 % with some six hundred.
    EXPECT_NEAR(cosine_weighted(set, [](const Direction&) { return 1.; }) / pi, 1, .01) << mu0;
    EXPECT_NEAR(cosine_weighted(set, [](const Direction& d) { return d.z() * d.z(); }) / (pi / 2), 1, .01) << mu0;
    EXPECT_NEAR(cosine_weighted(set, [](const Direction& d) { return d.x() * d.x(); }) / (pi / 4), 1, .02) << mu0;
  }
}

TEST(GatherDirections, CrowdAboutTheSunEnoughForItsPeak) {
  // An overhead sun's Henyey-Greenstein light through a horizontal plane: int_0^1 c P(c) dc / 2 in closed form.
  for (const double g : {.85, .95}) {
    const auto peak = [g](double c) { return (1 - g * g) / std::pow(1 + g * g - 2 * g * c, 1.5); };
    const auto antiderivative =
        [g](double c) {  // of c P(c): with q^2 = 1 + g^2 - 2 g c, c dc = -(1 + g^2 - q^2) q dq / (2 g^2)
          const double q = std::sqrt(1 + g * g - 2 * g * c);
          return (1 - g * g) / (2 * g * g) * ((1 + g * g) / q + q);
        };
    const double truth = .5 * (antiderivative(1) - antiderivative(0));
    const auto flux = [&](const std::vector<GatherDirection>& set) {
      return cosine_weighted(set, [&](const Direction& d) { return peak(-d.z()) / (4 * pi); });
    };
    const double crowded = flux(gather_directions(512, false, Direction(0, 0, -1)));
    EXPECT_NEAR(crowded / truth, 1, .01);
  }
}

TEST(GatherDirections, OfLightThatLeavesUpwardCrowdAboutAGrazingSun) {
  // A horizontal beam's Henyey-Greenstein light: half goes up. Its flux up is 1/(2 pi) int sin^2(t) P(cos t) dt.
  constexpr double g = .85;
  const auto peak = [](double c) { return (1 - g * g) / std::pow(1 + g * g - 2 * g * c, 1.5); };
  double truth = 0;
  constexpr int steps = 20000;
  for (int i = 0; i < steps; ++i) {
    const double angle = pi * (i + .5) / steps;
    truth += std::sin(angle) * std::sin(angle) * peak(std::cos(angle)) / (2 * pi) * pi / steps;
  }
  const Direction sun = travel_along(-1e-6, 37);
  const auto set = gather_directions(512, true, sun);
  EXPECT_NEAR(static_cast<double>(set.size()), 512 + 64, 2);
  for (const auto& d : set) EXPECT_GT(d.travel.z(), 0);
  const double found = cosine_weighted(set, [&](const Direction& d) { return peak(d.dot(sun)) / (4 * pi); });
  EXPECT_NEAR(found / truth, 1, .01);  // as of the peak of an overhead sun
}

TEST(GatherDirections, AreSpacedAsTheirOwnSetIs) {
  const Direction sun = travel_along(-.2, 37);
  for (const bool upward : {false, true}) {
    const auto alone = gather_directions(512, upward, std::nullopt);
    const auto mixed = gather_directions(512, upward, sun);
    ASSERT_GT(mixed.size(), alone.size());
    for (std::size_t i = 0; i < mixed.size(); ++i) {
      EXPECT_LT(mixed[i].weight, mixed[i].spacing);  // both sets share its light
      if (i < alone.size()) {
        EXPECT_EQ(mixed[i].spacing, alone[i].weight);
      }
    }
  }
}

TEST(PeakDirections, StandAtTheirAnglesFromTheSun) {
  const Direction sun = travel_along(-.3, 37);
  const std::vector<PeakAngle> angles{{1., 400.}, {.99, 50.}, {.9, 2.}, {.5, .1}};
  const auto set = peak_directions(angles, sun);
  ASSERT_GE(set.size(), 3U);
  for (std::size_t i = 0; i < set.size(); ++i) {
    EXPECT_LT(set[i].travel.z(), 0);
    EXPECT_NEAR(set[i].travel.norm(), 1, 1e-14);
    const auto angle = std::find_if(angles.begin(), angles.end(), [&](const PeakAngle& a) {
      return std::abs(a.cos_angle - set[i].travel.dot(sun)) < 1e-12;
    });
    ASSERT_NE(angle, angles.end());
    EXPECT_NEAR(set[i].weight, 1 / (4 * angle->density), 1e-15);
    EXPECT_EQ(set[i].spacing, set[i].weight);
  }
}

// A scene whose scattered source at every control point is the cell's `source`.
struct Scene {
  BoxGrid box;
  Cells<double> cells;
  DirectionalSource<double> source;
  GroundRadiance<double> ground;
  GatherScene<double> gather;

  Scene(const BoxGrid& given, const std::vector<float>& extinction, const std::vector<double>& value, double sky,
        double surface)
      : box(given),
        cells(make_cells<double>(make_grid(box, extinction, 1.), untruncated, false)),
        source{ControlPoints(12), AngularField<double>(12, cells.size()), -Direction::UnitZ(), {}},
        ground{{}, AngularField<double>(1, box.columns()), {}},
        gather{box, cells, &source, {}, sky, &ground} {
    std::fill_n(ground.at_points.row(0), box.columns(), surface);
    const auto dense = dense_indices(cells.rows);
    for (int m = 0; m < 12; ++m) {
      for (std::size_t c = 0; c < cells.size(); ++c) source.at_points.row(m)[c] = value[dense[c]];
    }
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
};

// Boxes of some hundred cells: threads would only wait for each other.
class GatherFlux : public testing::Test {
 protected:
  GatherFlux() { omp_set_num_threads(1); }
  ~GatherFlux() override { omp_set_num_threads(threads_); }

 private:
  int threads_ = omp_get_max_threads();
};

BoxGrid unequal_box(bool periodic) {
  BoxGrid box = make_box(8, 6, 0, periodic);
  box.dx_m = 30;
  box.dy_m = 20;
  box.z_edge_m = {0, 10, 35, 36, 80, 120, 150};
  return box;
}

double mean(const std::vector<double>& field) {
  return std::accumulate(field.begin(), field.end(), 0.) / static_cast<double>(field.size());
}

// 2 E_3(tau) = 2 int_0^1 mu exp(-tau/mu) dmu, the diffuse transmission; midpoints, good to 1e-7.
double diffuse_transmission(double tau) {
  double sum = 0;
  constexpr int n = 4000;
  for (int i = 0; i < n; ++i) sum += 2 * (i + .5) / n * std::exp(-tau * n / (i + .5)) / n;
  return sum;
}

TEST_F(GatherFlux, UniformSlabHasTheExponentialIntegral) {
  // Source 2 in a slab of optical depth .6 over a surface of radiance 3, below a sky of 5.
  for (const bool upward : {true, false}) {
    const BoxGrid box = unequal_box(true);
    const Scene scene(box, std::vector<float>(cells_of(box), .004F), std::vector<double>(cells_of(box), 2.), 5, 3);
    const auto directions = gather_directions(512, upward, std::nullopt);
    for (const int edge : {0, 3, 6}) {
      const auto flux = gather_flux(scene.gather, edge, upward, directions);
      const double path = .004 * (upward ? box.z_edge_m[edge] : 150 - box.z_edge_m[edge]);
      const double beyond = upward ? 3 : 5;
      const double through = diffuse_transmission(path);
      for (const double f : flux)
        EXPECT_NEAR(f / (pi * (2 + (beyond - 2) * through)), 1, 1e-3) << edge;  // 512 directions
      if (edge != 3) continue;
      for (const float f : gather_level_fluxes(scene.gather, std::array{edge}, upward, directions))
        EXPECT_NEAR(f / (pi * (2 + (beyond - 2) * through)), 1, 1e-3);
    }
  }
}

constexpr std::array inner_edges{1, 2, 3, 4, 5};

TEST_F(GatherFlux, BetweenBottomAndTopTheForwardMarchHasTheSameMeans) {
  // The same directions, backwards and forwards, on average over a periodic box: each does the other's crossings, with
  // uniform extinction and sources that differ.
  const BoxGrid box = unequal_box(true);
  Random random(1);
  std::vector<double> value(cells_of(box));
  for (double& v : value) v = 1 + .2 * random();
  const Scene scene(box, std::vector<float>(cells_of(box), .004F), value, 5, 3);
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
  const Scene scene(box, random_extinction(box, .1, 2), value, 5, 3);
  for (const bool upward : {true, false}) {
    const auto directions = gather_directions(64, upward, std::nullopt);
    const auto all = gather_level_fluxes(scene.gather, inner_edges, upward, directions);
    const auto alone = gather_level_fluxes(scene.gather, std::array{4}, upward, directions);
    for (std::size_t c = 0; c < box.columns(); ++c) EXPECT_EQ(alone[c], all[3 * box.columns() + c]);
  }
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
  const Scene scene(box, extinction, bright, 0, 0);
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

TEST_F(GatherFlux, FurnaceGivesPiWhateverIsBetween) {
  for (const bool periodic : {true, false}) {
    const BoxGrid box = unequal_box(periodic);
    Scene scene(box, random_extinction(box, .1, 2), std::vector<double>(cells_of(box), 1.), 1, 1);
    scene.gather.side_radiance = [&box](const Direction&) { return std::vector<double>(box.nz() + 1, 1.); };
    // On average: the blur moves light of the distance from columns that see far to those that do not.
    for (const bool upward : {true, false}) {
      const auto directions = gather_directions(128, upward, std::nullopt);
      const auto forward = gather_level_fluxes(scene.gather, inner_edges, upward, directions);
      for (std::size_t e = 0; e < inner_edges.size(); ++e) {
        const auto at = forward.begin() + static_cast<std::ptrdiff_t>(box.columns() * e);
        EXPECT_NEAR(mean({at, at + static_cast<std::ptrdiff_t>(box.columns())}), pi, 2e-6);  // float
      }
      for (const int edge : {0, 6}) {
        const auto flux = gather_flux(scene.gather, edge, upward, directions);
        EXPECT_NEAR(mean(flux), pi, 1e-12);  // rounding
      }
    }
  }
}

TEST_F(GatherFlux, BlurMovesLightButMakesNone) {
  // Sources that differ from column to column around a mean give on average the flux of the mean. Transmission is the
  // same everywhere, so the flux is linear in the source (contrasts too low for the limiter).
  const BoxGrid box = unequal_box(true);
  Random random(3);
  std::vector<double> structured(cells_of(box)), uniform(cells_of(box));
  for (int k = 0; k < box.nz(); ++k) {
    const std::size_t first = static_cast<std::size_t>(k) * box.columns();
    double sum = 0;
    for (std::size_t c = 0; c < box.columns(); ++c) sum += structured[first + c] = 1 + .3 * random();
    for (std::size_t c = 0; c < box.columns(); ++c) uniform[first + c] = sum / static_cast<double>(box.columns());
  }
  const std::vector<float> extinction(cells_of(box), .004F);
  const Scene a(box, extinction, structured, 0, 0);
  const Scene b(box, extinction, uniform, 0, 0);
  for (const bool upward : {true, false}) {
    const auto directions = gather_directions(128, upward, std::nullopt);
    const int edge = upward ? box.nz() : 0;
    const auto flux = gather_flux(a.gather, edge, upward, directions);
    EXPECT_NEAR(mean(flux) / mean(gather_flux(b.gather, edge, upward, directions)), 1, 1e-12);  // rounding
    const auto [low, high] = std::minmax_element(flux.begin(), flux.end());
    EXPECT_GT(*high / *low, 1.001);
  }
}

TEST_F(GatherFlux, SharedGradientsAreTheDirectionsOwnWhereTheSourceIsTheSameInAll) {
  // Varied cells share one relative gradient between directions; that of a source without direction is everyone's.
  const BoxGrid box = unequal_box(true);
  Random random(5);
  std::vector<double> value(cells_of(box));
  for (double& v : value) v = .2 + random();
  Scene scene(box, random_extinction(box, .1, 2), value, 5, 3);
  for (const bool upward : {true, false}) {
    const auto directions = gather_directions(128, upward, std::nullopt);
    scene.cells.heterogeneous = false;
    const auto own = gather_flux(scene.gather, upward ? 6 : 0, upward, directions);
    const auto own_levels = gather_level_fluxes(scene.gather, inner_edges, upward, directions);
    scene.cells.heterogeneous = true;
    const auto shared = gather_flux(scene.gather, upward ? 6 : 0, upward, directions);
    const auto shared_levels = gather_level_fluxes(scene.gather, inner_edges, upward, directions);
    for (std::size_t c = 0; c < own.size(); ++c) EXPECT_NEAR(shared[c], own[c], 1e-12);  // rounding
    for (std::size_t c = 0; c < own_levels.size(); ++c)
      EXPECT_NEAR(shared_levels[c], own_levels[c], 1e-5);  // fluxes of the forward march are float
  }
}

TEST_F(GatherFlux, DistantLightIsSpreadWhereDirectionsAreFew) {
  // One bright thin cell far above the plane: 32 directions alone would light 32 spots of 40 x 40 columns.
  BoxGrid box = make_box(40, 40, 30);
  std::vector<float> extinction(cells_of(box), 0.F);
  const std::size_t cell = (29 * 40 + 20) * 40 + 20;
  extinction[cell] = .1F;
  std::vector<double> value(cells_of(box), 0.);
  value[cell] = 1;
  const Scene scene(box, extinction, value, 0, 0);
  const auto flux = gather_flux(scene.gather, 0, false, gather_directions(32, false, std::nullopt));
  const auto lit = std::count_if(flux.begin(), flux.end(), [](double f) { return f > 0; });
  EXPECT_GT(lit, 800);  // half the plane
}

TEST_F(GatherFlux, EmptyBoxShowsSkyAndSurface) {
  const BoxGrid box = unequal_box(true);
  const std::vector<float> nothing(cells_of(box), 0.F);
  Scene scene(box, nothing, std::vector<double>(cells_of(box), 0.), 5, 0);
  const Direction sun = travel_along(-.5, 37);
  for (const double f : gather_flux(scene.gather, 0, false, gather_directions(512, false, std::nullopt)))
    EXPECT_NEAR(f, 5 * pi, 1e-12);
  // The weights of the mixture with the sun's directions sum to pi within 1 % (see above).
  for (const double f : gather_flux(scene.gather, 0, false, gather_directions(512, false, sun)))
    EXPECT_NEAR(f, 5 * pi, .05 * pi);
  Random random(4);
  double* const leaving = scene.ground.at_points.row(0);
  for (std::size_t c = 0; c < box.columns(); ++c) leaving[c] = random();
  const auto flux = gather_flux(scene.gather, 6, true, gather_directions(512, true, std::nullopt));
  EXPECT_NEAR(mean(flux), pi * mean({leaving, leaving + box.columns()}), 1e-12);  // each ray meets one column
  const auto here = gather_flux(scene.gather, 0, true, gather_directions(64, true, std::nullopt));
  for (std::size_t c = 0; c < box.columns(); ++c) EXPECT_NEAR(here[c], pi * leaving[c], 1e-12);
}

TEST(DirectionalSource, AddsTheBeamsOwnPhaseFunctionToThePoints) {
  // Linear between points, so constants are kept; the first order follows its phase function exactly.
  const BoxGrid box = make_box(2, 1, 1);
  Scene scene(box, {1.F, 1.F}, {3., 4.}, 0, 0);
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
