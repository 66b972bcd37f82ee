#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "../near_with_report.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/reflection_table.hpp"
#include "cloudbow/optics/surface_brdf.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

Direction travel(double mu, double azimuth_deg) {
  const double sine = std::sqrt(1 - mu * mu);
  const double azimuth = azimuth_deg * pi / 180;
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), mu};
}

struct Model {
  const char* name;
  SurfaceBrdf brdf;
};

std::vector<Model> models() {
  return {{"lambertian", SurfaceBrdf::lambertian(.3)},
          {"rpv", SurfaceBrdf::rpv(.1, .7, -.24, .1)},
          {"ross-li", SurfaceBrdf::ross_li(.2, .1, .03)},
          {"cox-munk", SurfaceBrdf::cox_munk(7, 1.34)}};
}

// ---- closed forms ---------------------------------------------------------------------------------------------------

TEST(SurfaceBrdf, LambertReflectsEvenly) {
  const SurfaceBrdf brdf = SurfaceBrdf::lambertian(.4);
  EXPECT_DOUBLE_EQ(brdf(travel(-.3, 10), travel(.8, 200)), .4 / pi);
  EXPECT_DOUBLE_EQ(brdf.directional_albedo(.3), .4);
}

TEST(SurfaceBrdf, RpvWithoutItsParametersIsLambert) {
  const SurfaceBrdf brdf = SurfaceBrdf::rpv(.25, 1, 0, 1);  // k = 1, theta = 0, no hot spot
  for (const double azimuth : {0., 70., 180.}) EXPECT_NEAR(brdf(travel(-.4, 0), travel(.7, azimuth)), .25 / pi, 1e-15);
  EXPECT_NEAR(brdf.directional_albedo(.5), .25, 1e-6);
}

TEST(SurfaceBrdf, RpvScattersBackWhereThetaIsNegative) {
  const SurfaceBrdf brdf = SurfaceBrdf::rpv(.1, 1, -.24, 1);
  const Direction arriving = travel(-.5, 0);
  const double back = brdf(arriving, -arriving);
  const double forward = brdf(arriving, travel(.5, 0));
  // F = (1 - theta^2) / (1 + theta^2 + 2 theta cos(phase))^1.5 with phases of 0 and 120 degrees.
  const auto f = [](double c) { return (1 - .0576) / std::pow(1.0576 - .48 * c, 1.5); };
  EXPECT_NEAR(back, .1 / pi * f(1), 1e-14);
  EXPECT_NEAR(forward, .1 / pi * f(-.5), 1e-14);
}

TEST(SurfaceBrdf, RossLiKernelsAreNoughtForSunAndSensorOverhead) {
  // Both kernels are normalised so (Lucht, Schaaf & Strahler 2000): K_vol = 0 and K_geo = 0 at nadir.
  EXPECT_NEAR(SurfaceBrdf::ross_li(.2, 1, 1)(travel(-1, 0), travel(1, 0)), .2 / pi, 1e-12);
}

TEST(SurfaceBrdf, RossThickAtTheHotSpotIsClosed) {
  // Phase angle 0: K_vol = pi/2 / (2 mu) - pi/4.
  const Direction arriving = travel(-.5, 30);
  EXPECT_NEAR(SurfaceBrdf::ross_li(0, 1, 0)(arriving, -arriving), (pi / 2 / 1. - pi / 4) / pi, 1e-12);
}

TEST(SurfaceBrdf, GlintOverheadIsFresnelTimesSlopes) {
  // Sun and sensor overhead: flat facets alone, f = R(0)/(4 pi variance), R(0) = ((n-1)/(n+1))^2.
  const double variance = .003 + .00512 * 5;
  const double fresnel = std::pow(.34 / 2.34, 2);
  EXPECT_NEAR(SurfaceBrdf::cox_munk(5, 1.34)(travel(-1, 0), travel(1, 0)), fresnel / (4 * pi * variance), 1e-12);
}

TEST(SurfaceBrdf, GlintLiesWhereAMirrorWouldSendIt) {
  const SurfaceBrdf brdf = SurfaceBrdf::cox_munk(2, 1.34);
  const Direction arriving = travel(-.7, 40);
  const double mirrored = brdf(arriving, travel(.7, 40));  // travels on in the same azimuth
  EXPECT_GT(mirrored, 50 * brdf(arriving, travel(.7, 220)));
  EXPECT_GT(mirrored, 5 * brdf(arriving, travel(.7, 80)));
}

TEST(SurfaceBrdf, NearlyFlatWaterReturnsFresnelsReflectance) {
  // Without wind the slopes' standard deviation is three degrees: a high sun finds a mirror, R(0) = ((n-1)/(n+1))^2 =
  // .0211, but for a per cent that slanted facets make.
  EXPECT_NEAR(SurfaceBrdf::cox_munk(0, 1.34).directional_albedo(1), std::pow(.34 / 2.34, 2), 3e-4);
}

// ---- invariance -----------------------------------------------------------------------------------------------------

TEST(SurfaceBrdf, SunAndSensorMayChangePlaces) {
  for (const Model& m : models()) {
    for (const double azimuth : {0., 50., 180.}) {
      const Direction a = travel(-.35, 0), b = travel(.8, azimuth);
      EXPECT_NEAR(m.brdf(a, b), m.brdf(-b, -a), 1e-14) << m.name;
    }
  }
}

TEST(SurfaceBrdf, OnlyTheAzimuthBetweenCounts) {
  for (const Model& m : models())
    EXPECT_NEAR(m.brdf(travel(-.35, 20), travel(.8, 75)), m.brdf(travel(-.35, 200), travel(.8, 255)), 1e-13) << m.name;
}

TEST(SurfaceBrdf, OutOfRangeIsAnInputError) {
  EXPECT_THROW(SurfaceBrdf::lambertian(1.2), InputError);
  EXPECT_THROW(SurfaceBrdf::rpv(-.1, 1, 0, 1), InputError);
  EXPECT_THROW(SurfaceBrdf::rpv(.1, 0, 0, 1), InputError);
  EXPECT_THROW(SurfaceBrdf::rpv(.1, 1, 1, 1), InputError);
  EXPECT_THROW(SurfaceBrdf::ross_li(-1, 0, 0), InputError);
  EXPECT_THROW(SurfaceBrdf::cox_munk(-1, 1.34), InputError);
  EXPECT_THROW(SurfaceBrdf::cox_munk(5, 1), InputError);
}

// ---- on control points ----------------------------------------------------------------------------------------------

TEST(ControlPointBrdf, FollowsTheModelAndItsReciprocity) {
  const ControlPoints points(642);
  // Away from the horizon; the spacing of 642 points is 9 degrees, a glint at 7 m/s is some 20 degrees wide.
  const struct {
    Model model;
    double tolerance;
  } cases[] = {{models()[0], 1e-12}, {models()[1], .01}, {models()[2], .01}, {models()[3], .15}};
  for (const auto& c : cases) {
    const ControlPointBrdf interpolated(c.model.brdf, points);
    double peak = 0;
    for (double azimuth = 0; azimuth < 360; azimuth += 11)
      peak = std::max(peak, c.model.brdf(travel(-.6, 0), travel(.6, azimuth)));
    for (double azimuth = 3; azimuth < 360; azimuth += 37) {
      const Direction a = travel(-.6, 12), b = travel(.75, azimuth);
      EXPECT_NEAR(interpolated(a, b), c.model.brdf(a, b), c.tolerance * peak) << c.model.name << " " << azimuth;
      EXPECT_NEAR(interpolated(a, b), interpolated(-b, -a), c.tolerance * peak) << c.model.name;
    }
  }
}

TEST(ReflectionTable, ReturnsTheModelsAlbedoUnderTheQuadrature) {
  const OrdinateSet ordinates = make_ordinate_set("double-gauss-8x16");
  const Direction sun = travel(-.5, 37);
  for (const Model& m : models()) {
    for (const double slope : {0., 25.}) {
      const ReflectionTable table = make_reflection_table(m.brdf, {slope, 60}, ordinates, sun);
      EXPECT_LE(table.albedo.maxCoeff(), 1);
      for (std::size_t q = 0; q < table.down.size(); ++q) {
        const int d = table.down[q];
        const double arriving = ordinates.weight[d] * -ordinates.direction[d].z();
        double returned = 0;
        for (std::size_t u = 0; u < table.up.size(); ++u) {
          const int o = table.up[u];
          returned += ordinates.weight[o] * ordinates.direction[o].z() * table.up_from_down(u, q);
        }
        EXPECT_NEAR(returned / arriving, table.albedo[q], 1e-12) << m.name;
        if (slope == 0) {
          EXPECT_NEAR(table.albedo[q], m.brdf.directional_albedo(-ordinates.direction[d].z()), 1e-12) << m.name;
        }
      }
      double from_beam = 0;
      for (std::size_t u = 0; u < table.up.size(); ++u)
        from_beam += ordinates.weight[table.up[u]] * ordinates.direction[table.up[u]].z() * table.up_from_beam[u];
      EXPECT_NEAR(from_beam, table.beam_albedo, 1e-12) << m.name;
    }
  }
}

TEST(ReflectionTable, NeverReturnsMoreThanArrives) {
  // Far beyond the range of the model's fit: k = .3 and rho0 = .9 reflect several times the incident light near the
  // horizon.
  const ReflectionTable table =
      make_reflection_table(SurfaceBrdf::rpv(.9, .3, 0, 1), {}, make_ordinate_set("double-gauss-8x16"), travel(-.1, 0));
  EXPECT_GT(table.largest_albedo, 1.5);
  EXPECT_LE(table.albedo.maxCoeff(), 1);
  EXPECT_LE(table.beam_albedo, 1);
}

TEST(ReflectionTable, ASlopeSendsTheGlintWhereItsMirrorPoints) {
  // A sun overhead and water tilted by 20 degrees towards azimuth 90: the mirror sends light 40 degrees off, to
  // azimuth 90.
  const ReflectionTable table = make_reflection_table(SurfaceBrdf::cox_munk(1, 1.34), {20, 90},
                                                      make_ordinate_set("double-gauss-8x16"), Direction(0, 0, -1));
  Eigen::Index brightest = 0;
  table.points_from_beam.maxCoeff(&brightest);
  const Direction mirror(0, std::sin(40 * pi / 180), std::cos(40 * pi / 180));
  Direction leaving = table.points.directions()[brightest];
  leaving.z() = std::abs(leaving.z());  // below the horizon the functions are mirror images
  EXPECT_GT(leaving.dot(mirror), std::cos(9 * pi / 180));
}

}  // namespace
}  // namespace cloudbow
