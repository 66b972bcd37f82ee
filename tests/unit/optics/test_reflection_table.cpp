// Reflectance at control points and ordinates. Truth: the model itself, its reciprocity and its albedo.
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
