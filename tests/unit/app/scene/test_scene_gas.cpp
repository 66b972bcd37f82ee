// Scenes at g-points: keys of [spectrum] and what else depends on the g-point. Truth: the numbers in the files that the
// tests write.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "../../medium/ecckd_example.hpp"
#include "cloudbow/app/assemble.hpp"
#include "cloudbow/app/scene.hpp"
#include "cloudbow/core/error.hpp"
#include "gas_scene.hpp"

namespace cloudbow {
namespace {

using gas_scene::air;
using gas_scene::longwave;
using gas_scene::longwave_spectrum;
using gas_scene::solar;
using gas_scene::solar_spectrum;
using gas_scene::sun;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class GasScene : public testing::Test {
 protected:
  std::vector<Scene> read(const std::string& text) { return read_scenes(files_.write(text)); }
  std::string message(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  /// A message has the form FILE:LINE: KEY, what was found and what is allowed.
  void expect_refused(const std::string& text, const std::string& key, const std::string& words) {
    EXPECT_THAT(message(text), AllOf(HasSubstr("scene.toml"), HasSubstr(key), HasSubstr(words), HasSubstr("found"),
                                     HasSubstr("allowed")))
        << text;
  }

  gas_scene::Files files_;
};

constexpr double rounding = 1e-12;

TEST_F(GasScene, ThereIsOneForEachPoint) {
  for (const std::string& text : {solar, longwave}) {
    const std::vector<Scene> scenes = read(text);
    ASSERT_EQ(scenes.size(), gas_scene::points);
    for (std::size_t g = 0; g < scenes.size(); ++g) {
      EXPECT_EQ(scenes[g].gas_point, static_cast<int>(g));
      EXPECT_FALSE(scenes[g].wavelength_um);
      EXPECT_EQ(scenes[g].broadband->model, scenes[0].broadband->model) << "read once";
    }
  }
}

TEST_F(GasScene, KeysOfTheSpectrum) {
  const SceneBroadband usual = *read(solar)[0].broadband;
  EXPECT_EQ(usual.method, SceneBroadband::Method::few);
  EXPECT_EQ(usual.few_tolerance, 1e-3);
  EXPECT_EQ(usual.few_points, 0);
  EXPECT_EQ(usual.file, "solar.nc");
  EXPECT_EQ(read(solar + "method = \"all\"\n")[3].broadband->method, SceneBroadband::Method::all);
  EXPECT_EQ(read(solar + "method = \"columns\"\n")[3].broadband->method, SceneBroadband::Method::columns);
  const SceneBroadband few = *read(solar + "method = \"few\"\nfew_tolerance = 0.01\nfew_points = 3\n")[1].broadband;
  EXPECT_EQ(few.few_tolerance, .01);
  EXPECT_EQ(few.few_points, 3);
}

TEST_F(GasScene, SharesOfTheSunSumToItsIrradiance) {
  double sum = 0;
  for (const Scene& scene : read(solar)) {
    const double share = gas_scene::solar_irradiance[static_cast<std::size_t>(scene.gas_point)] / 16;
    EXPECT_NEAR(scene.sun->irradiance_w_m2, share * 1360, 1360 * rounding);
    EXPECT_EQ(scene.sun->zenith_deg, 40);
    EXPECT_FALSE(scene.thermal);
    sum += scene.sun->irradiance_w_m2;
  }
  EXPECT_NEAR(sum, 1360, 1360 * rounding);
}

TEST_F(GasScene, PlanckRadiancesSumToTheLawOfStefanAndBoltzmann) {
  const std::vector<Scene> scenes = read(longwave + "[sky]\ntemperature_k = 200\n");
  const auto black = [](double kelvin) { return gas_scene::stefan_boltzmann * std::pow(kelvin, 4) / std::numbers::pi; };
  double at_300 = 0, ground = 0, sky = 0, halfway = 0;
  for (const Scene& scene : scenes) {
    ASSERT_TRUE(scene.thermal);
    EXPECT_EQ(scene.thermal->flux_units(), "W m-2");
    at_300 += scene.thermal->planck(300);
    halfway += scene.thermal->planck(275);
    ground += scene.surface.planck;
    sky += scene.sky_radiance;
  }
  EXPECT_NEAR(at_300 / black(300), 1, rounding) << "a node of the model's table";
  EXPECT_NEAR(sky / black(200), 1, rounding);
  EXPECT_NEAR(halfway / (.5 * (black(250) + black(300))), 1, rounding) << "linear between the nodes";
  EXPECT_NEAR(ground / (.1 * black(250) + .9 * black(300)), 1, rounding);
}

// Each g-point has one interval, in which the table is linear: its mean is that of the middle.
TEST_F(GasScene, BulkOpticsAreAveragedOverThePoint) {
  const double visible = gas_scene::bulk_extinction(1e4 / .55);
  for (const Scene& scene : read(gas_scene::cloud + solar)) {
    const double middle = gas_scene::first_interval_cm1 + 4000 * (scene.gas_point + .5);
    const SceneCloud& cloud = scene.clouds.at(0);
    EXPECT_NEAR(*cloud.extinction_m2_per_g, gas_scene::bulk_extinction(middle), rounding);
    EXPECT_NEAR(*cloud.relative_extinction, gas_scene::bulk_extinction(middle) / visible, 1e-9);
    EXPECT_NEAR(*cloud.single_scattering_albedo, .9, rounding);
    EXPECT_EQ(scene.phase_functions[static_cast<std::size_t>(cloud.phase_function)].function.key(),
              PhaseFunction::henyey_greenstein(.8).key());
  }
}

// A voxel of .02 per metre in the visible.
TEST_F(GasScene, ExtinctionGridsAreVisible) {
  const double visible = gas_scene::bulk_extinction(1e4 / .55);
  for (const Scene& scene : read(gas_scene::cloud + solar)) {
    const double middle = gas_scene::first_interval_cm1 + 4000 * (scene.gas_point + .5);
    const Problem problem = assemble(scene, std::uint64_t{1} << 30).problem;
    float largest = 0;
    for (const auto& of_phase : problem.grid.scattering) {
      for (const float value : of_phase) largest = std::max(largest, value);
    }
    constexpr double of_float = 1e-6;
    EXPECT_NEAR(largest / (.9 * .02 * gas_scene::bulk_extinction(middle) / visible), 1, of_float);
  }
}

const std::string wants_depth = "[output]\nfields = [\"fluxes\", \"optical_depth\", \"extinction\"]\n";

// The depth is that of the visible at each g-point: an extinction grid gives it as it stands. Towers of .02 per metre
// times 100 m and of .01 times 50 m.
TEST_F(GasScene, OpticalDepthIsVisible) {
  for (const Scene& scene : read(gas_scene::cloud + wants_depth + solar)) {
    std::vector<float> expected(12, 0.F);
    expected[4 + 1] = 2;
    expected[4 + 2] = .5F;
    const AssembledScene assembled = assemble(scene, std::uint64_t{1} << 30);
    const std::vector<float>& found = assembled.cloud_optical_depth;
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t c = 0; c < found.size(); ++c) EXPECT_FLOAT_EQ(found[c], expected[c]);
    const BoxGrid& box = assembled.problem.grid.box;
    for (std::size_t c = 0; c < found.size(); ++c) {
      double depth = 0;
      for (int k = 0; k < box.nz(); ++k) depth += assembled.cloud_extinction[k * found.size() + c] * box.thickness_m(k);
      EXPECT_NEAR(depth, expected[c], 1e-6) << "of float";
    }
    ASSERT_EQ(assembled.clouds.size(), 1U);
    EXPECT_EQ(assembled.clouds[0].optical_depth_um, SceneCloud::visible_um);
    EXPECT_NEAR(assembled.clouds[0].optical_depth.sum, 2.5, 1e-6);
    EXPECT_NEAR(assembled.clouds[0].optical_depth.largest, 2, 1e-6);
  }
}

/// Droplets of 8 and 12 um, whose extinction is 1.5 / r_e at .55 um and proportional to the wavenumber.
void write_water_table(const std::filesystem::path& path, const std::vector<double>& wavenumber_cm1) {
  constexpr double visible_cm1 = 1e4 / SceneCloud::visible_um;
  NetcdfBuilder file(path);
  const std::vector<double> radius{8, 12};
  file.dimension("effective_radius", radius.size());
  file.dimension("wavenumber", wavenumber_cm1.size());
  file.variable("wavenumber", {"wavenumber"}, "cm-1", wavenumber_cm1, NC_DOUBLE);
  file.variable("effective_radius", {"effective_radius"}, "um", radius, NC_DOUBLE);
  std::vector<double> extinction;
  for (const double r : radius) {
    for (const double at : wavenumber_cm1) extinction.push_back(1.5 / r * at / visible_cm1);
  }
  const std::vector<std::string> dimensions{"effective_radius", "wavenumber"};
  file.variable("mass_extinction_coefficient", dimensions, "m2 g-1", extinction, NC_DOUBLE);
  file.variable("single_scattering_albedo", dimensions, "1", std::vector<double>(extinction.size(), .9), NC_DOUBLE);
  file.variable("asymmetry_factor", dimensions, "1", std::vector<double>(extinction.size(), .8), NC_DOUBLE);
  file.close();
}

// Mixtures of two radii have the extinction 1.5 / r_e too.
TEST_F(GasScene, OpticalDepthOfWaterIsVisible) {
  write_water_table(files_.folder / "water.nc", {1000, 30000});
  const CloudField water =
      make_cloud_field({2, 1, 2}, {100, 100, 50}, {0, 0, 500}, {.5F, .25F, .5F, 0}, "liquid_water_content");
  write_cloud_vdb(files_.folder / "water.vdb", water, {}, {{"reff", "effective_radius", "um", {8, 12, 10}}});
  const auto expect_depths = [&](const std::string& radius_key, double first, double second, double most) {
    const std::string cloud = "[cloud]\nfile = \"water.vdb\"\nphase_function = \"drops\"\n" + radius_key +
                              "\n[phase_function.drops]\ntype = \"bulk\"\nfile = \"water.nc\"\n";
    for (const Scene& scene : read(cloud + wants_depth + solar)) {
      const AssembledScene assembled = assemble(scene, std::uint64_t{1} << 30);
      const std::vector<float>& found = assembled.cloud_optical_depth;
      ASSERT_EQ(found.size(), 2U);
      constexpr double of_float = 1e-6;
      EXPECT_NEAR(found[0] / first, 1, of_float) << "g-point " << scene.gas_point;
      EXPECT_NEAR(found[1] / second, 1, of_float) << "g-point " << scene.gas_point;
      const auto largest = static_cast<double>(*std::ranges::max_element(assembled.cloud_extinction));
      EXPECT_NEAR(largest / most, 1, of_float) << "g-point " << scene.gas_point;
    }
  };
  expect_depths("effective_radius_grid = \"reff\"", 50 * .5 * 1.5 * (1 / 8. + 1 / 10.), 50 * .25 * 1.5 / 12,
                .5 * 1.5 / 8);
  expect_depths("effective_radius_um = 10", 50 * 1. * 1.5 / 10, 50 * .25 * 1.5 / 10, .5 * 1.5 / 10);
}

// Droplets of extinction .02 per metre and crystals of 8 and 12 um in .5 g/m3 of ice share a voxel; a second voxel has
// crystals alone. Molecules scatter by a function of their own.
TEST_F(GasScene, ConstituentsHaveTheirOpticsAtEachPoint) {
  write_water_table(files_.folder / "ice.nc", {1000, 30000});
  const std::array<double, 3> voxel{100, 100, 50};
  write_cloud_vdb(files_.folder / "cloud.vdb",
                  make_cloud_field({2, 1, 1}, voxel, {0, 0, 500}, {.02F, 0}, "extinction"));
  write_cloud_vdb(files_.folder / "ice.vdb",
                  make_cloud_field({2, 1, 1}, voxel, {0, 0, 500}, {.5F, .5F}, "ice_water_content"), {},
                  {{"reff", "effective_radius", "um", {8, 12}}});
  const std::string clouds =
      "[[cloud]]\nname = \"liquid\"\nfile = \"cloud.vdb\"\neffective_radius_um = 10\nphase_function = \"drops\"\n"
      "[[cloud]]\nname = \"ice\"\nfile = \"ice.vdb\"\neffective_radius_grid = \"reff\"\n"
      "phase_function = \"crystals\"\n[phase_function.drops]\ntype = \"bulk\"\nfile = \"bulk.nc\"\n"
      "[phase_function.crystals]\ntype = \"bulk\"\nfile = \"ice.nc\"\n";
  const double visible_cm1 = 1e4 / SceneCloud::visible_um;
  for (const Scene& scene : read(clouds + wants_depth + solar)) {
    const double middle = gas_scene::first_interval_cm1 + 4000 * (scene.gas_point + .5);
    const AssembledScene assembled = assemble(scene, std::uint64_t{1} << 30);
    const OpticalGrid& grid = assembled.problem.grid;
    const auto molecules = static_cast<std::size_t>(scene.broadband->molecules_phase_function);
    std::vector<double> scattering;
    grid.for_each_span([&](int, int, const RowSpan& span) {
      for (std::uint32_t cell = span.offset; cell < span.offset + static_cast<std::uint32_t>(span.n); ++cell) {
        double sum = 0;
        for (std::size_t p = 0; p < grid.scattering.size(); ++p) sum += p == molecules ? 0 : grid.scattering[p][cell];
        if (sum > 0) scattering.push_back(sum);
      }
    });
    const double liquid = .9 * .02 * gas_scene::bulk_extinction(middle) / gas_scene::bulk_extinction(visible_cm1);
    const auto ice = [&](double radius_um) { return .9 * .5 * 1.5 / radius_um * middle / visible_cm1; };
    constexpr double of_float = 1e-6;
    ASSERT_EQ(scattering.size(), 2U);
    EXPECT_NEAR(scattering[0] / (liquid + ice(8)), 1, of_float) << "g-point " << scene.gas_point;
    EXPECT_NEAR(scattering[1] / ice(12), 1, of_float) << "g-point " << scene.gas_point;
    EXPECT_NEAR(assembled.cloud_optical_depth.at(0) / (50 * (.02 + .5 * 1.5 / 8)), 1, of_float);
    EXPECT_NEAR(assembled.cloud_optical_depth.at(1) / (50 * .5 * 1.5 / 12), 1, of_float);
  }
}

// Spheres of two radii by one name: a table with both rows. Each constituent has the optics of its radius alone, but
// for the sizes at which the table is computed.
TEST_F(GasScene, ConstituentsShareATableByMieTheory) {
  const auto constituent = [](const std::string& name, const std::string& radius) {
    return "[[cloud]]\nname = \"" + name + "\"\nfile = \"cloud.vdb\"\neffective_radius_um = " + radius +
           "\nphase_function = \"drops\"\n";
  };
  const std::string drops = "[phase_function.drops]\ntype = \"bulk\"\nsubstance = \"water\"\n";
  const Scene both = read(constituent("small", "3") + constituent("large", "4") + drops + solar)[1];
  for (std::size_t n = 0; n < 2; ++n) {
    const Scene one = read(constituent("alone", n == 0 ? "3" : "4") + drops + solar)[1];
    EXPECT_NEAR(*both.clouds.at(n).extinction_m2_per_g / *one.clouds.at(0).extinction_m2_per_g, 1, 1e-3);
    EXPECT_NEAR(*both.clouds.at(n).single_scattering_albedo, *one.clouds.at(0).single_scattering_albedo, 1e-5);
  }
  EXPECT_GT(*both.clouds[0].extinction_m2_per_g, *both.clouds[1].extinction_m2_per_g);
}

// A model of 600 to 900 cm-1 can do with a table that ends long before the visible; the optical depth cannot.
TEST_F(GasScene, OpticalDepthOfVaryingDropletsNeedsAVisibleTable) {
  ecckd_example::make_file(files_.folder / "infrared.nc");
  write_water_table(files_.folder / "water.nc", {500, 1000});
  const std::string text =
      "[cloud]\nfile = \"cloud.vdb\"\nphase_function = \"drops\"\neffective_radius_grid = \"reff\"\n"
      "[phase_function.drops]\ntype = \"bulk\"\nfile = \"water.nc\"\n" +
      air + "o3 = 1e-7\nch4 = 2e-6\n[thermal]\n[surface]\ntemperature_k = 295\n[spectrum]\n" +
      "gas_model = \"infrared.nc\"\n";
  EXPECT_EQ(message(text), "no error");
  expect_refused(wants_depth + text, "output.fields", "water.nc: too short");
}

TEST_F(GasScene, BandsNeedAllPointsOfAModel) {
  const std::string wants_bands = "[output]\nfields = [\"bands\"]\n";
  EXPECT_TRUE(read(wants_bands + solar + "method = \"all\"\n")[0].output.bands);
  expect_refused(wants_bands + solar, "output.fields", "\"few\"");
  expect_refused(wants_bands + sun +
                     "[[layer]]\nbottom_m = 0\ntop_m = 1\noptical_depth = 1\nsingle_scattering_albedo = 1\n"
                     "phase_function = \"rayleigh\"\n",
                 "output.fields", "no spectrum.gas_model");
}

TEST_F(GasScene, OpticalDepthNeedsACloud) { expect_refused(wants_depth + solar, "output.fields", "no [cloud]"); }

TEST_F(GasScene, GasesAreNumbersOrLists) {
  const std::string profile = "[atmosphere]\nheight_m = [0, 20000]\nstandard = \"us-1976\"\n";
  const auto fractions = [&](const std::string& gases) {
    return read(profile + gases + sun + solar_spectrum)[0].atmosphere->air.mole_fraction;
  };
  EXPECT_THAT(fractions("h2o = 0.01\n")["h2o"], ElementsAre(.01, .01));
  EXPECT_THAT(fractions("h2o = [0.01, 1e-5]\n")["h2o"], ElementsAre(.01, 1e-5));
  EXPECT_THAT(fractions("h2o = 0\nco2_ppm = 400\n")["co2"],
              ElementsAre(testing::DoubleEq(400e-6), testing::DoubleEq(400e-6)));
}

TEST_F(GasScene, ListsAreForWavelengths) {
  expect_refused(air + sun + "[surface]\nalbedo = [0.1, 0.2, 0.3, 0.4]\n" + solar_spectrum, "surface.albedo",
                 "wavelengths_um");
}

TEST_F(GasScene, SpectralAlbedo) {
  files_.folder.write("ground.csv", "# wavelength [um], albedo\n0.2,0.3\n5,0.3\n");
  for (const Scene& scene : read(air + sun + "[surface]\nspectral_albedo = \"ground.csv\"\n" + solar_spectrum))
    EXPECT_NEAR(scene.surface.albedo, .3, rounding);
  expect_refused(air + sun + "[surface]\nalbedo = 0.1\nspectral_albedo = \"ground.csv\"\n" + solar_spectrum,
                 "surface.spectral_albedo", "stands beside `albedo`");
}

TEST_F(GasScene, WrongKeysOfTheSpectrum) {
  expect_refused(solar + "wavelengths_um = [0.5]\n", "spectrum.gas_model", "stands beside `wavelengths_um`");
  expect_refused(solar + "method = \"some\"\n", "spectrum.method", "\"some\"");
  expect_refused(solar + "method = \"all\"\nfew_points = 2\n", "spectrum.few_points", "method = \"few\"");
  expect_refused(solar + "method = \"columns\"\nfew_tolerance = 0.1\n", "spectrum.few_tolerance", "method = \"few\"");
  expect_refused(solar + "few_tolerance = 0\n", "spectrum.few_tolerance", "1e-6 to .1");
  expect_refused(solar + "few_points = 0\n", "spectrum.few_points", "0");
  expect_refused(solar + "few_points = 5\n", "spectrum.few_points", "5");
  expect_refused(air + sun + "[spectrum]\ngas_model = \"none.nc\"\n", "spectrum.gas_model", "none.nc");
  expect_refused(air + sun + "[spectrum]\ngas_model = \"cloud.vdb\"\n", "spectrum.gas_model", "no gas model");
  expect_refused(air + sun + "[spectrum]\nwavelengths_um = [0.5]\nmethod = \"all\"\n", "spectrum.method",
                 "a setting of gas_model");
}

TEST_F(GasScene, LightAndAirMustFitTheModel) {
  expect_refused(sun + solar_spectrum, "atmosphere", "missing");
  expect_refused(air + solar_spectrum, "sun", "missing");
  expect_refused(air + "[surface]\nalbedo = 0.1\n" + longwave_spectrum, "thermal", "missing");
  expect_refused(air + longwave_spectrum, "thermal", "missing");
  expect_refused(longwave + sun, "sun", "longwave");
  expect_refused(air + sun + longwave_spectrum, "sun", "longwave");
  expect_refused(solar + "[thermal]\n", "thermal", "model of sunlight");
  expect_refused(air + "[thermal]\nband_um = [8, 12]\n[surface]\ntemperature_k = 300\n" + longwave_spectrum,
                 "thermal.band_um", "stands beside spectrum.gas_model");
  expect_refused(air + "[thermal]\nwavelength_um = 10\n[surface]\ntemperature_k = 300\n" + longwave_spectrum,
                 "thermal.wavelength_um", "stands beside spectrum.gas_model");
  expect_refused(air + "[thermal]\n" + longwave_spectrum, "surface.temperature_k", "missing");
  expect_refused(air + "[sun]\nzenith_deg = 0\nazimuth_deg = 0\n" + solar_spectrum, "sun.irradiance_w_m2", "missing");
  expect_refused(air + "[sun]\nzenith_deg = 0\nazimuth_deg = 0\nirradiance_w_m2 = 0\n" + solar_spectrum,
                 "sun.irradiance_w_m2", "no light");
  expect_refused(solar + "[sky]\nradiance_w_m2_sr = 1\n", "sky.radiance_w_m2_sr", "has no spectrum");
  expect_refused(longwave + "[sky]\nradiance_w_m2_sr = 1\n", "sky.radiance_w_m2_sr", "has no spectrum");
  expect_refused(longwave + "[[radiance]]\nname = \"a\"\nzenith_deg = 0\nquantity = \"brightness_temperature\"\n",
                 "quantity", "one spectral interval");
}

TEST_F(GasScene, WrongGases) {
  const auto refused = [&](const std::string& gases, const std::string& key, const std::string& words) {
    expect_refused("[atmosphere]\nstandard = \"us-1976\"\nheight_m = [0, 20000]\n" + gases + sun + solar_spectrum, key,
                   words);
  };
  refused("h2o = 2\n", "atmosphere.h2o", "0 to 1");
  refused("h2o = [0.1]\n", "atmosphere.h2o", "1 numbers");
  refused("h2o = [0.1, -1]\n", "atmosphere.h2o", "0 to 1");
  refused("h2o = 0\nco2 = 1e-4\nco2_ppm = 400\n", "atmosphere.co2_ppm", "stands beside `co2`");
  refused("h2o = 0\nco2_ppm = 1e9\n", "atmosphere.co2_ppm", "0, or 1 to 1e5");
  refused("h2o = 0\nco2_ppm = 4e-4\n", "atmosphere.co2_ppm", "write co2 = 0.0004");
  expect_refused("[atmosphere]\nstandard = \"us-1976\"\nh2o = [0.1, 0.2]\n" + sun + solar_spectrum, "atmosphere.h2o",
                 "2 numbers");
}

TEST_F(GasScene, WrongBulkOptics) {
  const auto cloud = [](const std::string& drops) {
    return "[cloud]\nfile = \"cloud.vdb\"\neffective_radius_um = 10\nphase_function = \"drops\"\n"
           "[phase_function.drops]\ntype = \"bulk\"\n" +
           drops;
  };
  expect_refused(cloud("") + solar, "phase_function.drops.file", "missing");
  expect_refused(cloud("file = \"bulk.nc\"\nsubstance = \"water\"\n") + solar, "phase_function.drops", "both");
  expect_refused(cloud("file = \"no.nc\"\n") + solar, "phase_function.drops.file", "no.nc");
  expect_refused(cloud("file = \"bulk.nc\"\neffective_radius_um = 9\n") + solar, "effective_radius_um", "10");
  expect_refused(cloud("substance = \"sand\"\n") + solar, "phase_function.drops.substance", "sand");
  expect_refused(cloud("file = \"bulk.nc\"\n") + "[sun]\nzenith_deg = 0\nazimuth_deg = 0\n",
                 "phase_function.drops.type", "needs spectrum.gas_model");
  std::string droplets = cloud("file = \"bulk.nc\"\n");
  droplets.replace(droplets.find("bulk\""), 5, "mie\"");
  expect_refused(droplets + solar, "phase_function.drops.wavelength_um", "type = \"bulk\"");
  std::string large = gas_scene::cloud;
  large.replace(large.find("= 10"), 4, "= 20");
  expect_refused(large + solar, "cloud.effective_radius_um", "12");
}

}  // namespace
}  // namespace cloudbow
