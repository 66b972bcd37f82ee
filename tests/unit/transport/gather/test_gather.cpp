#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "gather_test_tools.hpp"
#include "transport/gather/gather.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

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
    EXPECT_NEAR(cosine_weighted(set, [](const Direction&) { return 1.; }) / pi, 1, 1e-12) << mu0;
    // Two independent point sets: 1 % with some six hundred.
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
      EXPECT_LT(mixed[i].weight, 1.02 * mixed[i].spacing);  // both sets share its light; scaled for isotropic light
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
    const SourceScene scene(box, std::vector<float>(cells_of(box), .004F), std::vector<double>(cells_of(box), 2.), 5,
                            3);
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

TEST_F(GatherFlux, FurnaceGivesPiWhateverIsBetween) {
  for (const bool periodic : {true, false}) {
    const BoxGrid box = unequal_box(periodic);
    SourceScene scene(box, random_extinction(box, .1, 2), std::vector<double>(cells_of(box), 1.), 1, 1);
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
  const SourceScene a(box, extinction, structured, 0, 0);
  const SourceScene b(box, extinction, uniform, 0, 0);
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
  SourceScene scene(box, random_extinction(box, .1, 2), value, 5, 3);
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
  const SourceScene scene(box, extinction, value, 0, 0);
  const auto flux = gather_flux(scene.gather, 0, false, gather_directions(32, false, std::nullopt));
  const auto lit = std::count_if(flux.begin(), flux.end(), [](double f) { return f > 0; });
  EXPECT_GT(lit, 800);  // half the plane
}

TEST_F(GatherFlux, EmptyBoxShowsSkyAndSurface) {
  const BoxGrid box = unequal_box(true);
  const std::vector<float> nothing(cells_of(box), 0.F);
  SourceScene scene(box, nothing, std::vector<double>(cells_of(box), 0.), 5, 0);
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

}  // namespace
}  // namespace cloudbow
