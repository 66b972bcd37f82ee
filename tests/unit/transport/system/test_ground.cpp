#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "cloudbow/sphere/ordinate_set.hpp"
#include "transport/grid/octants.hpp"
#include "transport/system/ground.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

TEST(ArrivingRays, AreFoundByColumn) {
  const BoxGrid box = make_box(3, 2, 1);
  const ArrivingRays<double> rays{
      {0, 1, 2, 3, 4, 5}, 4, -1};  // column (i, j) has the ray (i - 1, j + 1), modulo the box
  EXPECT_EQ(rays.by_column(box), (std::vector<double>{5, 3, 4, 2, 0, 1}));
}

class GroundOf : public testing::Test {
 protected:
  BoxGrid box = make_box(4, 3, 1);
  OrdinateSet ordinates = make_ordinate_set("double-gauss-2x4");
  std::vector<ArrivingRays<double>> arriving{static_cast<std::size_t>(ordinates.size())};

  // Radiance 1 along all downward ordinates in every column.
  void light_everywhere() {
    for (int d = 0; d < ordinates.size(); ++d)
      if (ordinates.direction[d].z() < 0) arriving[d].radiance.assign(box.columns(), 1.);
  }

  Ground<double>::Reflection reflected(const Surface& surface, std::span<const double> direct) const {
    std::vector<double> flux(octants / 2 * box.columns());
    for (int d = 0; d < ordinates.size(); ++d) {
      if (!arriving[d].radiance.empty()) add_arriving(arriving[d], ordinates, d, box, flux);
    }
    return Ground<double>(surface, ordinates, std::nullopt).reflect(arriving, flux, direct, ordinates, box);
  }
};

// Isotropic radiance 1 has the flux pi. A Lambertian surface sends back A times that, as radiance A.
TEST_F(GroundOf, LambertianSurfaceReflectsTheFlux) {
  light_everywhere();
  Surface surface;
  surface.albedo = .3;
  const std::vector<double> direct(box.columns(), 2.);
  const auto reflection = reflected(surface, direct);
  for (std::size_t c = 0; c < box.columns(); ++c) {
    EXPECT_NEAR(reflection.flux[c], std::numbers::pi + 2, 1e-12);
    EXPECT_NEAR(reflection.leaving.row(0)[c], .3 * (1 + 2 / std::numbers::pi), 1e-12);
  }
  EXPECT_NEAR(reflection.absorbed, .7 * (std::numbers::pi + 2), 1e-12);
}

TEST_F(GroundOf, LightReachesTheColumnOfItsRay) {
  light_everywhere();
  int lit = -1;
  for (int d = 0; d < ordinates.size(); ++d) {
    if (arriving[d].radiance.empty()) continue;
    arriving[d].radiance.assign(box.columns(), 0.);
    lit = d;
  }
  arriving[lit].radiance[0] = 1;
  arriving[lit].shift_x = 3;
  arriving[lit].shift_y = 1;
  const auto reflection = reflected(Surface{}, {});
  const double power = ordinates.weight[lit] * -ordinates.direction[lit].z();
  for (std::size_t c = 0; c < box.columns(); ++c) EXPECT_EQ(reflection.flux[c], c == 1 * 4 + 3 ? power : 0.);
}

// Kirchhoff's law: in an enclosure of one temperature the radiance is that of a black body, whatever the albedo.
TEST_F(GroundOf, EmissionAndReflectionAddUpToBlackBody) {
  light_everywhere();
  for (const double albedo : {0., .4, 1.}) {
    Surface surface;
    surface.albedo = albedo;
    surface.planck = 1;
    const auto reflection = reflected(surface, {});
    for (std::size_t c = 0; c < box.columns(); ++c) EXPECT_NEAR(reflection.leaving.row(0)[c], 1, 1e-12);
  }
}

}  // namespace
}  // namespace cloudbow
