// Scenes without their clouds. Truth: the same scenes without [cloud], solved by themselves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/planning/clear_sky.hpp"
#include "broadband_tools.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

using namespace broadband_tools;
using testing::AllOf;
using testing::HasSubstr;

class ClearSky : public testing::Test {
 protected:
  std::vector<Scene> scenes(const std::string& text) { return read_scenes(files_.write(text)); }
  static std::vector<Solution> without_clouds(const std::vector<Scene>& scenes) {
    CloudFiles files(true);
    return solve_clear_sky(scenes, options_for(1), memory, files);
  }
  std::string message(const std::string& text) {
    try {
      check_clear_sky(scenes(text).front());
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  gas_scene::Files files_;
  const std::string layer_ =
      "[[layer]]\nbottom_m = 0\ntop_m = 2000\noptical_depth = 0.3\nsingle_scattering_albedo = 0.9\n"
      "phase_function = \"rayleigh\"\n";
  const std::string grey_ =
      "[cloud]\nfile = \"cloud.vdb\"\nsingle_scattering_albedo = 1\nphase_function = \"isotropic\"\n";
};

TEST_F(ClearSky, IsTheSceneWithoutCloud) {
  for (const std::string& text : {gas_scene::solar, gas_scene::longwave}) {
    const std::vector<Solution> clear = without_clouds(scenes(gas_scene::cloud + settings + text));
    ASSERT_EQ(clear.size(), 1U) << "the sum over the g-points";
    const BroadbandRun alone = run(scenes(settings + text + "method = \"all\"\n"));
    const Solution& expected = alone.solved.solutions[0];
    EXPECT_EQ(clear[0].box.z_edge_m, expected.box.z_edge_m);
    EXPECT_EQ(clear[0].upwelling_flux, expected.upwelling_flux);
    EXPECT_EQ(clear[0].downwelling_diffuse_flux, expected.downwelling_diffuse_flux);
    EXPECT_EQ(clear[0].direct_flux, expected.direct_flux);
    EXPECT_EQ(clear[0].profile_upwelling_flux, expected.profile_upwelling_flux);
    EXPECT_EQ(clear[0].ledger.power, expected.ledger.power);
    EXPECT_TRUE(clear[0].absorbed_power.empty()) << "fluxes alone";
  }
}

TEST_F(ClearSky, IsOneForEachWavelength) {
  const std::string rest = layer_ +
                           "[sun]\nzenith_deg = 40\nazimuth_deg = 0\n[solver]\naccuracy = \"draft\"\n"
                           "[spectrum]\nwavelengths_um = [0.5, 0.7]\n[surface]\nalbedo = [0.1, 0.3]\n";
  const std::vector<Solution> clear = without_clouds(scenes(grey_ + rest));
  const std::vector<Solution> alone = single_solves(scenes(rest));
  ASSERT_EQ(clear.size(), 2U);
  for (std::size_t n = 0; n < 2; ++n) {
    EXPECT_EQ(clear[n].upwelling_flux, alone[n].upwelling_flux);
    EXPECT_EQ(clear[n].direct_flux, alone[n].direct_flux);
  }
  EXPECT_NE(clear[0].upwelling_flux, clear[1].upwelling_flux);
}

// Images, cameras, listed heights and modes belong to the cloudy scene.
TEST_F(ClearSky, OutputsOfTheCloudySceneAreLeftOut) {
  const std::string more =
      "[[radiance]]\nname = \"n\"\nzenith_deg = 0\nwidth = 4\nheight = 3\n"
      "[[camera]]\nname = \"c\"\nposition_m = [10, 10, 1]\nlook_at_m = [10, 10, 900]\nwidth = 4\nheight = 3\n"
      "[output]\nflux_levels = [550.0, 600.0]\n[solver]\naccuracy = \"draft\"\nmode = \"3d\"\n";
  const std::vector<Solution> clear = without_clouds(scenes(grey_ + layer_ + gas_scene::sun + more));
  ASSERT_EQ(clear.size(), 1U);
  EXPECT_TRUE(clear[0].images.empty());
  EXPECT_TRUE(clear[0].camera_images.empty());
  EXPECT_EQ(clear[0].flux_level.size(), clear[0].box.z_edge_m.size()) << "all levels";
}

TEST_F(ClearSky, SaysWhereThereIsNone) {
  const auto refused = [&](const std::string& text, const std::string& found) {
    EXPECT_THAT(message(text), AllOf(HasSubstr("scene.toml: --clear-sky"), HasSubstr("found " + found),
                                     HasSubstr("allowed a cloud with [[layer]]")));
  };
  refused(layer_ + gas_scene::sun, "no [cloud]");
  refused(gas_scene::solar, "no [cloud]");
  refused(grey_ + gas_scene::sun, "a cloud alone");
  refused(grey_ + layer_ + gas_scene::sun + "[surface]\nalbedo_map = \"cloud.vdb\"\n", "surface.albedo_map");
  EXPECT_EQ(message(grey_ + layer_ + gas_scene::sun), "no error");
  EXPECT_EQ(message(gas_scene::cloud + gas_scene::solar), "no error");
}

}  // namespace
}  // namespace cloudbow
