// Emission of a scene. Truth: the standard atmosphere, whose temperature is linear in height below 11 km.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "app/assembly/thermal.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

Scene scene_with(const std::string& optical_depth) {
  const TemporaryFolder folder;
  return read_scene(folder.write("scene.toml",
                                 "[thermal]\nwavelength_um = 10.8\n[atmosphere]\nstandard = \"us-1976\"\n"
                                 "[surface]\ntemperature_k = 288\n[[layer]]\nbottom_m = 0\ntop_m = 8000\n"
                                 "single_scattering_albedo = 0.5\nphase_function = \"isotropic\"\noptical_depth = " +
                                     optical_depth + "\n"));
}

// Planck radiance is curved over 50 K, and hardly over the 0.65 K of 100 m.
TEST(EmissionLevels, DivideTallLayersThatEmit) {
  const std::vector<double> tall = emission_levels(scene_with("1"), nullptr, {0, 8000});
  EXPECT_GT(tall.size(), 2U);
  for (const double z : tall) EXPECT_TRUE(z >= 0 && z <= 8000) << z;
  const std::vector<double> flat = emission_levels(scene_with("1"), nullptr, {0, 100});
  EXPECT_LT(flat.size(), tall.size());
  EXPECT_TRUE(emission_levels(scene_with("0"), nullptr, {0, 8000}).empty()) << "nothing emits";
}

TEST(EmissionLevels, AreNoneBetweenTheVoxelsOfACloud) {
  const CloudField cloud =
      make_cloud_field({1, 1, 80}, {100, 100, 100}, {0, 0, 0}, std::vector<float>(80, 1.F), "extinction");
  EXPECT_TRUE(emission_levels(scene_with("1"), &cloud, {0, 8000}).empty());
}

TEST(AtmosphereDoubt, IsSaidOfDomainsBeyondTheProfile) {
  const Scene scene = scene_with("1");
  const double top = scene.atmosphere->air.height_m.back();
  EXPECT_FALSE(doubt_atmosphere(scene, {0, top}));
  EXPECT_THAT(doubt_atmosphere(scene, {0, top + 1}).value(), testing::HasSubstr("does not cover the domain"));
}

}  // namespace
}  // namespace cloudbow
