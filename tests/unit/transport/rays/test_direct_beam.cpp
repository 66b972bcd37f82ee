#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "transport/rays/direct_beam.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

BoxGrid unequal_box(bool periodic) {
  BoxGrid box = make_box(6, 5, 0, periodic);
  box.dx_m = 30;
  box.dy_m = 20;
  box.z_edge_m = {0, 10, 35, 36, 80, 120};
  return box;
}

template <class Real>
std::vector<Real> extinction_of(const OpticalGrid& grid) {
  std::vector<Real> extinction;
  for (std::size_t c = 0; c < grid.active_cells(); ++c)
    extinction.push_back(static_cast<Real>(grid.absorption[c] + grid.scattering[0][c]));
  return extinction;
}

template <class Real>
DirectBeam<Real> beam_through(const OpticalGrid& grid, const Sun& sun, const std::vector<double>& layers,
                              const BeamOptions& options = {}) {
  const auto extinction = extinction_of<Real>(grid);
  return direct_beam<Real>(grid.box, active_rows(grid), extinction, layers, sun, options);
}

std::vector<Sun> suns() {
  return {{travel_along(-1, 0), 1.},
          {travel_along(-.8, 0), 1.},
          {travel_along(-.5, 37), 2.},
          {travel_along(-.1, 200), 1361.}};
}

double mean_flux(const std::vector<double>& level_flux, std::size_t columns, int edge) {
  const auto first = level_flux.begin() + static_cast<std::ptrdiff_t>(columns) * edge;
  return std::accumulate(first, first + static_cast<std::ptrdiff_t>(columns), 0.) / static_cast<double>(columns);
}

// Power that the beam leaves in the cells per area of the top.
template <class Real>
double extinguished(const OpticalGrid& grid, const DirectBeam<Real>& beam) {
  const auto extinction = extinction_of<Real>(grid);
  const auto dense = dense_indices(active_rows(grid));
  double sum = 0;
  for (std::size_t c = 0; c < dense.size(); ++c) {
    const int k = static_cast<int>(dense[c] / grid.box.columns());
    sum += static_cast<double>(extinction[c]) * static_cast<double>(beam.irradiance[c]) * grid.box.thickness_m(k);
  }
  return sum / static_cast<double>(grid.box.columns());
}

template <class Real>
class DirectBeamOf : public testing::Test {
 public:
  // Mean transmissions of thin cells are a series to t^7, off by t^8/9! < 1.1e-8 at t = 1/2; float adds its rounding.
  static constexpr double tolerance = std::is_same_v<Real, float> ? 1e-6 : 2e-8;
  // In float an optical path of up to ten, summed over some fifty cells, is accurate to 2e-6; so is the transmitted
  // light.
  static constexpr double closed_form_tolerance = std::is_same_v<Real, float> ? 3e-6 : 2e-8;
};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(DirectBeamOf, Precisions);

TYPED_TEST(DirectBeamOf, SlabFollowsBeerAndLambert) {
  // At open sides of a box full of one layer, incident light has crossed the layer to the ray's depth: the same closed
  // form.
  for (const bool periodic : {true, false}) {
    const BoxGrid box = unequal_box(periodic);
    const double sigma = .0078125;
    const OpticalGrid grid = make_grid(box, std::vector<float>(cells_of(box), static_cast<float>(sigma)), 1.);
    const double top = box.z_edge_m.back();
    for (const Sun& sun : suns()) {
      const double mu0 = -sun.travel.z();
      const auto beam = beam_through<TypeParam>(grid, sun, std::vector<double>(box.nz(), sigma));
      ASSERT_EQ(beam.level_flux.size(), box.columns() * (box.nz() + 1));
      for (std::size_t n = 0; n < beam.level_flux.size(); ++n) {
        const double truth = mu0 * sun.irradiance * std::exp(-sigma * (top - box.z_edge_m[n / box.columns()]) / mu0);
        EXPECT_NEAR(beam.level_flux[n] / truth, 1, this->closed_form_tolerance);
      }
      const auto dense = dense_indices(active_rows(grid));
      for (std::size_t c = 0; c < dense.size(); ++c) {
        const auto k = dense[c] / box.columns();
        const double path = sigma * (box.z_edge_m[k + 1] - box.z_edge_m[k]) / mu0;
        const double truth =
            sun.irradiance * std::exp(-sigma * (top - box.z_edge_m[k + 1]) / mu0) * -std::expm1(-path) / path;
        EXPECT_NEAR(static_cast<double>(beam.irradiance[c]) / truth, 1, this->closed_form_tolerance);
      }
      if (periodic) {
        EXPECT_EQ(beam.side_gain, 0);
        EXPECT_EQ(beam.side_loss, 0);
      }
    }
  }
}

TYPED_TEST(DirectBeamOf, LosesWhatTheCellsTake) {
  // Flux through the top + in through sides = flux through the bottom + out + extinguished, whatever the field; both
  // sums have the beam's own rounding. Fluxes fall from level to level of a periodic box.
  for (const bool periodic : {true, false}) {
    for (const double largest : {1e-4, .01, 1.}) {
      const BoxGrid box = unequal_box(periodic);
      const OpticalGrid grid = make_grid(box, random_extinction(box, largest, 1), .5);
      for (const Sun& sun : suns()) {
        const auto beam = beam_through<TypeParam>(grid, sun, std::vector<double>(box.nz(), 0.));
        const double in = mean_flux(beam.level_flux, box.columns(), box.nz()) + beam.side_gain;
        const double out = mean_flux(beam.level_flux, box.columns(), 0) + beam.side_loss + extinguished(grid, beam);
        EXPECT_NEAR(out / in, 1, this->tolerance);
        EXPECT_NEAR(mean_flux(beam.level_flux, box.columns(), box.nz()), -sun.travel.z() * sun.irradiance,
                    this->tolerance * sun.irradiance);
        if (periodic) {
          for (int e = 0; e < box.nz(); ++e) {
            const double above = mean_flux(beam.level_flux, box.columns(), e + 1);
            EXPECT_LE(mean_flux(beam.level_flux, box.columns(), e), above * (largest < .1 ? 1 - 1e-9 : 1));
          }
        } else if (sun.travel.z() > -.9) {
          EXPECT_GT(beam.side_loss, 0);
          EXPECT_GT(beam.side_gain, 0);
        }
      }
    }
  }
}

TEST(DirectBeam, OpenSidesLetInWhatTheGeometrySays) {
  // An empty box: per metre of height, the sunlit sides of dy x depth and dx x depth receive F0 |Ox| and F0 |Oy|.
  const BoxGrid box = unequal_box(false);
  const OpticalGrid grid = make_grid(box, std::vector<float>(cells_of(box), 0.F), 1.);
  for (const Sun& sun : suns()) {
    const auto beam = beam_through<double>(grid, sun, std::vector<double>(box.nz(), 0.));
    const double depth = box.z_edge_m.back();
    const double truth =
        sun.irradiance * depth *
        (std::abs(sun.travel.x()) / (box.nx * box.dx_m) + std::abs(sun.travel.y()) / (box.ny * box.dy_m));
    // Four rays per column and axis count the sides they cross to an eighth of the three or more columns they move.
    EXPECT_NEAR(beam.side_gain, truth, .05 * truth + 1e-12);
    EXPECT_NEAR(beam.side_gain, beam.side_loss, 1e-12 * sun.irradiance);
    for (const double f : beam.level_flux) EXPECT_NEAR(f, -sun.travel.z() * sun.irradiance, 1e-12 * sun.irradiance);
  }
}

TEST(DirectBeam, ColumnsByThemselvesSeeOnlyTheirOwnExtinction) {
  const BoxGrid box = unequal_box(true);
  const auto extinction = random_extinction(box, .05, 2);
  const OpticalGrid grid = make_grid(box, extinction, 1.);
  const Sun sun{travel_along(-.3, 37), 1.};
  const auto beam = beam_through<double>(grid, sun, std::vector<double>(box.nz(), 0.), {16, true});
  for (std::size_t column = 0; column < box.columns(); ++column) {
    double path = 0;
    for (int k = 0; k < box.nz(); ++k)
      path += static_cast<double>(extinction[k * box.columns() + column]) * box.thickness_m(k) / .3;
    EXPECT_NEAR(beam.level_flux[column], .3 * std::exp(-path), 2e-8);  // the series of thin cells
  }
}

TEST(DirectBeam, ShadowFallsWhereTheSunSays) {
  // Fluxes to 1e-6: rays are held off the faces by 1e-7 of a column. One opaque cell is at height 80 to 120, and the
  // sun in the west (light travels towards +x). The slope is 3 columns of 30 m in 80 m of height: the shadow on the
  // ground lies three columns to the east of the base.
  const BoxGrid box = unequal_box(true);
  std::vector<float> extinction(cells_of(box), 0.F);
  extinction[(4 * 5 + 2) * 6 + 1] = 10.F;
  const Direction travel = Direction(90, 0, -80).normalized();
  const auto beam =
      beam_through<double>(make_grid(box, extinction, 1.), {travel, 1.}, std::vector<double>(box.nz(), 0.));
  const double open = -travel.z();
  for (int j = 0; j < 5; ++j) EXPECT_NEAR(beam.level_flux[j * 6 + 4], j == 2 ? 0 : open, 1e-6);
  // Its 40 m of height throw one and a half columns more, round the box.
  EXPECT_NEAR(beam.level_flux[2 * 6 + 5], 0, 1e-6);
  EXPECT_NEAR(beam.level_flux[2 * 6 + 0], open / 2, .13 * open);  // to the half of one in four rays
  EXPECT_NEAR(beam.level_flux[2 * 6 + 3], open, 1e-6);
}

TEST(DirectBeam, NoShadowComesRoundAnOpenSide) {
  // The light travels towards +x, and an opaque tower stands in the last column there: its shadow leaves the box. Rays
  // in its column and their neighbours share footprints. At the ground, three columns of travel further, they are
  // within their columns again, but for the 1e-7 that holds them off the faces.
  const BoxGrid box = unequal_box(false);
  std::vector<float> extinction(cells_of(box), 0.F);
  for (const int k : {0, 1, 2, 3}) extinction[(k * 5 + 2) * 6 + 5] = 10.F;
  const Direction travel = Direction(60, 0, -80).normalized();
  const auto beam =
      beam_through<double>(make_grid(box, extinction, 1.), {travel, 1.}, std::vector<double>(box.nz(), 0.));
  for (int e = 0; e <= box.nz(); ++e) {
    for (int c = 0; c < 30; ++c) {
      if (c == 2 * 6 + 5 || (c == 2 * 6 + 4 && e > 0)) continue;
      EXPECT_NEAR(beam.level_flux[e * 30 + c], -travel.z(), 1e-6) << "interface " << e << ", column " << c;
    }
  }
  EXPECT_NEAR(beam.level_flux[2 * 6 + 5], 0, 1e-6);
}

TEST(DirectBeam, BitsDoNotDependOnThreads) {
  const BoxGrid box = unequal_box(false);
  const OpticalGrid grid = make_grid(box, random_extinction(box, .05, 3), .5);
  const Sun sun{travel_along(-.3, 37), 1.};
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const auto one = beam_through<float>(grid, sun, std::vector<double>(box.nz(), .001));
  omp_set_num_threads(2);
  const auto two = beam_through<float>(grid, sun, std::vector<double>(box.nz(), .001));
  omp_set_num_threads(threads);
  EXPECT_EQ(one.irradiance, two.irradiance);
  EXPECT_EQ(one.level_flux, two.level_flux);
  EXPECT_EQ(one.side_gain, two.side_gain);
  EXPECT_EQ(one.side_loss, two.side_loss);
}

TEST(DirectBeamSlopes, UniformLayersHaveTheClosedForm) {
  // Irradiance exp(-t (1/2 - z)) over the cell, z from the centre: slope = 12 <z F> / <F>.
  const BoxGrid box = unequal_box(true);
  const std::vector<float> extinction(cells_of(box), .02F);
  const OpticalGrid grid = make_grid(box, extinction, 1.);
  BeamOptions options;
  options.parts.slopes = true;
  for (const Sun& sun : suns()) {
    const auto beam = beam_through<double>(grid, sun, std::vector<double>(box.nz(), 0.), options);
    std::size_t c = 0;
    double off = 0;
    for (int k = 0; k < box.nz(); ++k) {
      const double t = .02F * box.thickness_m(k) / -sun.travel.z();
      const double phi1 = -std::expm1(-t) / t, phi2 = (1 - phi1) / t;
      const double truth = 12 * (.5 - (phi1 - phi2) / phi1);
      for (std::size_t column = 0; column < box.columns(); ++column, ++c) {
        if (beam.irradiance[c] < 1e-15) continue;
        off = std::max({off, std::abs(beam.slope[2][c] / truth - 1), std::abs(beam.slope[0][c] / truth),
                        std::abs(beam.slope[1][c] / truth)});
      }
    }
    EXPECT_LT(off, .03) << "sixteen rays do not fill a column evenly";
  }
}

TEST(DirectBeamSlopes, FallAwayFromALitSide) {
  // A wall of one column: sunlight that travels along +x and little down fades across it.
  const BoxGrid box = make_box(8, 1, 1, false);
  std::vector<float> extinction(8, 0.F);
  extinction[4] = 3.F;
  const OpticalGrid grid = make_grid(box, extinction, 1.);
  BeamOptions options;
  options.parts.slopes = true;
  options.rays = 64;
  const Sun sun{travel_along(-.05, 0), 1.};
  const auto beam = beam_through<double>(grid, sun, {0.}, options);
  // Nearly horizontal rays: exp(-3 (x + 1/2)), as above.
  const double phi1 = -std::expm1(-3.) / 3, phi2 = (1 - phi1) / 3;
  EXPECT_NEAR(beam.slope[0][0], 12 * ((phi1 - phi2) / phi1 - .5), .15);
  const auto back = beam_through<double>(grid, {travel_along(-.05, 180), 1.}, {0.}, options);
  EXPECT_NEAR(back.slope[0][0], -beam.slope[0][0], 1e-3) << "the mirror image";
  const auto in_float = beam_through<float>(grid, sun, {0.}, options);
  EXPECT_NEAR(static_cast<double>(in_float.slope[0][0]), beam.slope[0][0], 1e-4);
  const auto without = beam_through<float>(grid, sun, {0.}, {.rays = 64});
  EXPECT_NEAR(in_float.irradiance[0] / without.irradiance[0], 1, 1e-5) << "slopes change nothing else";
}

}  // namespace
}  // namespace cloudbow
