// Keys of emission and of the air. Truth: the table of keys that the scene format promises; Planck radiances by
// PlanckFunction.
#include <gmock/gmock.h>

#include "cloudbow/app/scene.hpp"
#include "cloudbow/core/error.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string layer = R"([[layer]]
bottom_m = 0
top_m = 3000
optical_depth = 0.1
single_scattering_albedo = 0
phase_function = "isotropic"
)";
const std::string air = "[atmosphere]\nstandard = \"us-1976\"\n";
const std::string thermal = "[thermal]\nwavelength_um = 10.8\n";
const std::string surface = "[surface]\ntemperature_k = 288.2\n";
const std::string whole = layer + air + thermal + surface;

Scene read(const std::string& text) {
  const TemporaryFolder folder;
  return read_scene(folder.write("scene.toml", text));
}

std::string message_of(const std::string& text) {
  try {
    read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ThermalScene, NeedsNoSun) {
  const Scene scene = read(whole);
  ASSERT_TRUE(scene.thermal);
  EXPECT_FALSE(scene.sun);
  EXPECT_EQ(scene.thermal->wavelength_um, 10.8);
  EXPECT_EQ(scene.thermal->flux_units(), "W m-2 um-1");
  EXPECT_EQ(scene.surface_temperature_k, 288.2);
  EXPECT_EQ(scene.surface.planck, PlanckFunction::at(10.8)(288.2));
  EXPECT_EQ(scene.atmosphere->source, "us-1976");
}

TEST(ThermalScene, BandAndSkyAndQuantities) {
  const Scene scene = read(layer + air + surface + R"([thermal]
band_um = [8.0, 12]
[sky]
temperature_k = 200
[[radiance]]
name = "nadir"
zenith_deg = 0
quantity = "brightness_temperature"
[[radiance]]
name = "slant"
zenith_deg = 50
quantity = "radiance"
[[camera]]
name = "eye"
type = "fisheye"
position_m = [0, 0, 1]
width = 2
height = 2
quantity = "brightness_temperature"
[output]
fields = ["fluxes", "heating_rate"]
)");
  EXPECT_EQ(scene.thermal->band_um, (std::array<double, 2>{8, 12}));
  EXPECT_EQ(scene.thermal->flux_units(), "W m-2");
  EXPECT_EQ(scene.sky_radiance, PlanckFunction::over({8, 12})(200));
  EXPECT_TRUE(scene.radiances[0].brightness_temperature);
  EXPECT_FALSE(scene.radiances[1].brightness_temperature);
  EXPECT_THAT(scene.thermal_cameras, ElementsAre("eye"));
  EXPECT_TRUE(scene.output.heating_rate);
  EXPECT_FALSE(scene.output.absorption);
}

TEST(ThermalScene, EachWavelengthOfASpectrumEmits) {
  const TemporaryFolder folder;
  const auto scenes = read_scenes(
      folder.write("scene.toml", layer + air + surface + "[thermal]\n[spectrum]\nwavelengths_um = [8.7, 10.8]\n"));
  ASSERT_EQ(scenes.size(), 2U);
  EXPECT_EQ(scenes[1].surface.planck, PlanckFunction::at(10.8)(288.2));
  EXPECT_THAT(message_of(layer + air + thermal + surface + "[spectrum]\nwavelengths_um = [8.7]\n"),
              AllOf(HasSubstr("scene.toml:10: thermal.wavelength_um"), HasSubstr("spectrum.wavelengths_um")));
}

TEST(ThermalScene, InlineAtmospheresAndWhatFillsThem) {
  const std::string heights = "[atmosphere]\nheight_m = [0, 5000]\ntemperature_k = [290, 255]\n";
  const Scene filled = read(layer + thermal + surface + heights + "standard = \"us-1976\"\n");
  EXPECT_EQ(filled.atmosphere->source, "inline");
  EXPECT_EQ(filled.atmosphere->air.temperature_at(0), 290);
  EXPECT_DOUBLE_EQ(filled.atmosphere->air.pressure_pa[1], us_standard_1976().pressure_at(5000));
  EXPECT_THAT(message_of(layer + thermal + surface + heights),
              AllOf(HasSubstr("atmosphere.pressure_pa: missing"), HasSubstr("us-1976")));
  const std::string whole_air = heights + "pressure_pa = [101325, 54000]\n";
  EXPECT_EQ(read(layer + thermal + surface + whole_air).atmosphere->air.pressure_pa[1], 54000);
  EXPECT_THAT(message_of(layer + thermal + surface + whole_air + "standard = \"us-1976\"\n"),
              HasSubstr("nothing is left to fill"));
  EXPECT_THAT(message_of(layer + thermal + surface +
                         "[atmosphere]\nheight_m = [0, 5000]\npressure_pa = [1e5, 5e4]\n"
                         "temperature_k = [17, -18]\n"),
              AllOf(HasSubstr("atmosphere.temperature_k: out of range (found 17"), HasSubstr("not Celsius")));
  EXPECT_THAT(message_of(layer + thermal + surface +
                         "[atmosphere]\nheight_m = [0, 5000]\npressure_pa = [1e5]\n"
                         "temperature_k = [290, 255]\n"),
              HasSubstr("atmosphere"));
  EXPECT_THAT(message_of(layer + thermal + surface + "[atmosphere]\n"), HasSubstr("atmosphere.standard: missing"));
  EXPECT_THAT(message_of(layer + thermal + surface + air + "h2o = [0.01, 0.001]\n"),
              HasSubstr("atmosphere.h2o: not one number for each of height_m"));
  EXPECT_THAT(message_of(layer + thermal + surface + air + "file = \"afglms.dat\"\n"),
              HasSubstr("stands beside `file`"));
}

TEST(ThermalScene, WhatIsMissingIsSaidOnce) {
  EXPECT_THAT(message_of(layer + air + thermal),
              AllOf(HasSubstr("surface.temperature_k: missing"), HasSubstr("scene.toml:9")));
  EXPECT_THAT(message_of(layer + thermal + surface), AllOf(HasSubstr("atmosphere: missing"), HasSubstr("us-1976")));
  EXPECT_THAT(message_of(layer + air + surface + "[thermal]\n"),
              AllOf(HasSubstr("thermal.wavelength_um"), HasSubstr("neither")));
  EXPECT_THAT(message_of(layer + "[sun]\nzenith_deg = 0\nazimuth_deg = 0\n[output]\nfields = [\"heating_rate\"]\n"),
              AllOf(HasSubstr("output.fields"), HasSubstr("[atmosphere]")));
}

TEST(ThermalScene, WrongNumbersAreRefused) {
  const auto with = [](const std::string& keys) { return message_of(layer + air + surface + "[thermal]\n" + keys); };
  EXPECT_THAT(with("wavelength_um = 10.8\nband_um = [8, 12]\n"), HasSubstr("exclude each other (found both"));
  EXPECT_THAT(with("band_um = [12, 8]\n"), HasSubstr("thermal.band_um: does not ascend (found [12, 8]"));
  EXPECT_THAT(with("band_um = [8]\n"), HasSubstr("not of length 2"));
  EXPECT_THAT(with("wavelength_um = -3\n"), HasSubstr("out of range"));
  EXPECT_THAT(with("wavelength_um = 1e6\n"), HasSubstr("thermal.wavelength_um"));
  EXPECT_THAT(message_of(layer + air + thermal + "[surface]\ntemperature_k = 15\n"),
              AllOf(HasSubstr("surface.temperature_k: out of range (found 15"), HasSubstr("not Celsius")));
  EXPECT_THAT(message_of(whole + "[sky]\ntemperature_k = 200\nradiance_w_m2_sr = 1\n"),
              HasSubstr("sky.temperature_k: excludes radiance_w_m2_sr"));
}

TEST(ThermalScene, KeysOfEmissionNeedThermal) {
  const std::string sunlit = layer + "[sun]\nzenith_deg = 0\nazimuth_deg = 0\n";
  for (const std::string& key :
       {std::string("[surface]\ntemperature_k = 288\n"), std::string("[surface]\ntemperature_map = \"t.nc\"\n"),
        std::string("[sky]\ntemperature_k = 200\n"),
        std::string("[[radiance]]\nname = \"a\"\nzenith_deg = 0\nquantity = \"brightness_temperature\"\n")}) {
    EXPECT_THAT(message_of(sunlit + key), HasSubstr("nothing emits without [thermal]")) << key;
  }
  EXPECT_THAT(read(sunlit + air).notes, ElementsAre(HasSubstr("atmosphere: not used")));
}

TEST(ThermalScene, TheSunNeedsItsIrradianceInTheUnitOfEmission) {
  const std::string sun = "[sun]\nzenith_deg = 0\nazimuth_deg = 0\n";
  EXPECT_THAT(message_of(whole + sun), AllOf(HasSubstr("sun.irradiance_w_m2: missing"), HasSubstr("W m-2 um-1")));
  const Scene scene = read(whole + sun + "irradiance_w_m2 = 0.24\n");
  EXPECT_EQ(scene.sun->irradiance_w_m2, .24);
  EXPECT_THAT(scene.notes, ElementsAre(HasSubstr("taken in W m-2 um-1")));
}

}  // namespace
}  // namespace cloudbow
