#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "../near_with_report.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/reflection_table.hpp"
#include "cloudbow/optics/surface_brdf.hpp"
#include "surface_test_tools.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

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

}  // namespace
}  // namespace cloudbow
