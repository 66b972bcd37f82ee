// Aerosol tables by humidity in scenes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "../../medium/netcdf_builder.hpp"
#include "cloudbow/app/assemble.hpp"
#include "cloudbow/app/scene.hpp"
#include "cloudbow/core/error.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

class SceneAerosol : public testing::Test {
 protected:
  TemporaryFolder folder_;

  // Albedos .9 and .8, asymmetry parameters .6 and .7, extinctions of 3 and 5 m2/g, at 50 and 90 %.
  void SetUp() override {
    NetcdfBuilder file(folder_ / "waso.mie.cdf");
    file.dimension("nlam", 1);
    file.dimension("nhum", 2);
    file.variable("wavelen", {"nlam"}, "micrometer", {.55}, NC_DOUBLE);
    file.variable("hum", {"nhum"}, "percent", {50, 90}, NC_DOUBLE);
    file.variable("ext", {"nlam", "nhum"}, "km^-1/(g/m^3)", {3000, 5000}, NC_DOUBLE);
    file.variable("ssa", {"nlam", "nhum"}, "", {.9, .8}, NC_DOUBLE);
    file.variable("gg", {"nlam", "nhum"}, "", {.6, .7}, NC_DOUBLE);
    file.close();
  }

  Scene read(const std::string& aerosol) const {
    std::ofstream(folder_ / "scene.toml") << "[phase_function.aerosol]\ntype = \"mie\"\nfile = \"waso.mie.cdf\"\n"
                                          << aerosol
                                          << "\n[[layer]]\nbottom_m = 0.0\ntop_m = 2000.0\noptical_depth = 0.3\n"
                                             "phase_function = \"aerosol\"\n[sun]\nzenith_deg = 30.0\n"
                                             "azimuth_deg = 0.0\nirradiance_w_m2 = 1.0\n[surface]\nalbedo = 0.1\n";
    return read_scenes(folder_ / "scene.toml").front();
  }
  std::string message(const std::string& aerosol) const {
    try {
      read(aerosol);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(SceneAerosol, LayerHasTheOpticsAtItsHumidity) {
  const Scene scene = read("relative_humidity_percent = 60.0");
  // A quarter of the way: extinctions .75 x 3 and .25 x 5, scattering by each albedo.
  const double lower = .75 * 3, upper = .25 * 5;
  const double scattered = .9 * lower + .8 * upper;
  ASSERT_EQ(scene.layers.size(), 1U);
  EXPECT_NEAR(scene.layers[0].single_scattering_albedo, scattered / (lower + upper), 1e-12);
  EXPECT_NEAR(scene.phase_functions[0].function.moment(1), (.9 * lower * .6 + .8 * upper * .7) / scattered, 1e-6);
  EXPECT_THAT(scene.notes, testing::Contains(HasSubstr("Henyey-Greenstein")));
}

// Of a cloud of aerosol the humidity gives extinction by mass; a radius beside it would choose another row.
TEST_F(SceneAerosol, CloudHasNoRadiusBesideTheHumidity) {
  folder_.write("cloud.vdb", "not read with the scene");
  const std::string cloud =
      "relative_humidity_percent = 50.0\n[cloud]\nfile = \"cloud.vdb\"\nphase_function = \"aerosol\"\n";
  const Scene scene = read(cloud);
  ASSERT_EQ(scene.clouds.size(), 1U);
  EXPECT_NEAR(scene.clouds[0].extinction_m2_per_g.value(), 3, 1e-12);
  EXPECT_FALSE(scene.clouds[0].effective_radius_um);
  EXPECT_THAT(message(cloud + "effective_radius_um = 5.0"), HasSubstr("one row"));
}

TEST_F(SceneAerosol, HumidityIsAskedForAndStandsAlone) {
  EXPECT_THAT(message(""), HasSubstr("relative_humidity_percent"));
  EXPECT_THAT(message("relative_humidity_percent = 95.0"), HasSubstr("allowed 50 to 90 %"));
  EXPECT_THAT(message("relative_humidity_percent = 120.0"), HasSubstr("0 to 100"));
  EXPECT_THAT(message("relative_humidity_percent = 60.0\neffective_radius_um = 1.0"), HasSubstr("one of the two"));
}

}  // namespace
}  // namespace cloudbow
