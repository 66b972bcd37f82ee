// Reading of scene files: every key is read, every mistake is reported with its location. Truth: the table of keys that
// the scene format promises.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cloudbow/app/scene.hpp"
#include "cloudbow/core/error.hpp"
#include "scene/scene_test_tools.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(Scene, EveryValueArrives) {
  const TemporaryFolder folder;
  const Scene scene = read_scene(folder.write("scene.toml", layers_toml));
  EXPECT_EQ(scene.title, "three layers");
  EXPECT_EQ(scene.text, layers_toml);
  EXPECT_TRUE(scene.clouds.empty());
  ASSERT_EQ(scene.layers.size(), 2u);
  EXPECT_EQ(scene.layers[0].bottom_m, 500);
  EXPECT_EQ(scene.layers[0].top_m, 1000);
  EXPECT_EQ(scene.layers[0].optical_depth, 10);
  EXPECT_EQ(scene.layers[0].single_scattering_albedo, 0.99);
  EXPECT_EQ(scene.layers[1].phase_function, 1);
  ASSERT_EQ(scene.phase_functions.size(), 2u);
  EXPECT_EQ(scene.phase_functions[0].name, "droplets");
  EXPECT_DOUBLE_EQ(scene.phase_functions[0].function.asymmetry_parameter(), 0.85);
  EXPECT_EQ(scene.phase_functions[1].function.key(), PhaseFunction::rayleigh().key());
  ASSERT_TRUE(scene.sun);
  EXPECT_EQ(scene.sun->zenith_deg, 60);
  EXPECT_EQ(scene.sun->azimuth_deg, 37);
  EXPECT_EQ(scene.sun->irradiance_w_m2, 1361);
  EXPECT_EQ(scene.surface.albedo, 0.25);
  EXPECT_EQ(scene.solver.accuracy, "fine");
  EXPECT_TRUE(scene.domain.periodic);
  EXPECT_TRUE(scene.output.absorption);
  EXPECT_FALSE(scene.output.actinic);
}

TEST(Scene, CloudAndSolverAndOutputKeys) {
  const TemporaryFolder folder;
  folder.write("cloud.vdb", "");
  const Scene scene = read_scene(folder.write("scene.toml", R"(
[cloud]
file = "cloud.vdb"
grid = "lwc"
quantity = "liquid_water_content"
scale = 2
voxel_size_m = [10, 20, 30.5]
up_axis = "y"
effective_radius_um = 12.5
single_scattering_albedo_grid = "ssa"
phase_function = "d"
[phase_function.d]
type = "double-henyey-greenstein"
forward_asymmetry_parameter = 0.9
backward_asymmetry_parameter = -0.5
forward_weight = 0.75
[domain]
boundary = "open"
min_m = [0, 0, -10]
max_m = [100, 200, 300]
[sky]
radiance_w_m2_sr = 3
[solver]
mode = "independent-columns"
control_points = 42
directions = "double-gauss-6x8"
delta_m_order = 5
fit = "least-squares"
gather_directions = 64
beam_rays = 9
tolerance = 1e-6
max_sweeps = 17
radiance_storage = "float16"
[output]
file = "out/result.h5"
flux_levels = [100, 0, 250.5]
fields = ["fluxes", "actinic", "errors", "optical_depth", "extinction"]
error_estimate = false
)"));
  ASSERT_EQ(scene.clouds.size(), 1U);
  EXPECT_EQ(scene.clouds[0].file, folder / "cloud.vdb");
  EXPECT_EQ(scene.clouds[0].read.grid, "lwc");
  EXPECT_EQ(scene.clouds[0].quantity, "liquid_water_content");
  EXPECT_EQ(scene.clouds[0].read.scale, 2);
  EXPECT_EQ(scene.clouds[0].read.voxel_size_m, (std::array<double, 3>{10, 20, 30.5}));
  EXPECT_EQ(scene.clouds[0].read.up_axis, "y");
  EXPECT_EQ(scene.clouds[0].effective_radius_um, 12.5);
  EXPECT_EQ(scene.clouds[0].single_scattering_albedo_grid, "ssa");
  EXPECT_DOUBLE_EQ(scene.phase_functions.at(0).function.asymmetry_parameter(), 0.75 * 0.9 - 0.25 * 0.5);
  EXPECT_FALSE(scene.domain.periodic);
  EXPECT_EQ(scene.domain.min_m, (std::array<double, 3>{0, 0, -10}));
  EXPECT_EQ(scene.domain.max_m, (std::array<double, 3>{100, 200, 300}));
  EXPECT_FALSE(scene.sun);
  EXPECT_EQ(scene.sky_radiance, 3);
  EXPECT_EQ(scene.solver.mode, SolveMode::independent_columns);
  EXPECT_EQ(scene.solver.control_points, 42);
  EXPECT_EQ(scene.solver.directions, "double-gauss-6x8");
  EXPECT_EQ(scene.solver.delta_m_order, 5);
  EXPECT_EQ(scene.solver.fit, FitMethod::least_squares);
  EXPECT_EQ(scene.solver.gather_directions, 64);
  EXPECT_EQ(scene.solver.beam_rays, 9);
  EXPECT_EQ(scene.solver.tolerance, 1e-6);
  EXPECT_EQ(scene.solver.max_sweeps, 17);
  EXPECT_TRUE(scene.solver.half_precision_radiance);
  EXPECT_EQ(scene.output.file, folder / "out/result.h5");
  EXPECT_EQ(scene.output.flux_levels, FluxLevels::listed);
  EXPECT_EQ(scene.output.heights_m, (std::vector<double>{0, 100, 250.5}));
  EXPECT_FALSE(scene.output.absorption);
  EXPECT_TRUE(scene.output.actinic);
  EXPECT_TRUE(scene.output.errors);
  EXPECT_TRUE(scene.output.optical_depth);
  EXPECT_TRUE(scene.output.extinction);
  EXPECT_FALSE(scene.output.error_estimate);
}

constexpr const char* constituents_toml = R"(
[[cloud]]
name = "liquid"
file = "cloud.vdb"
grid = ["ql", "qr"]
single_scattering_albedo = 1
phase_function = "rayleigh"
[[cloud]]
name = "ice"
file = "ice.vdb"
quantity = "ice_water_content"
effective_radius_um = 30
single_scattering_albedo = 0.9
phase_function = "isotropic"
[sun]
zenith_deg = 0
azimuth_deg = 0
)";

TEST(Scene, Constituents) {
  const TemporaryFolder folder;
  folder.write("cloud.vdb", "");
  folder.write("ice.vdb", "");
  const Scene scene = read_scene(folder.write("scene.toml", constituents_toml));
  ASSERT_EQ(scene.clouds.size(), 2U);
  EXPECT_EQ(scene.clouds[0].name, "liquid");
  EXPECT_EQ(scene.clouds[0].key, "cloud.0");
  EXPECT_EQ(scene.clouds[0].read.grid, "ql");
  EXPECT_EQ(scene.clouds[0].more_grids, (std::vector<std::string>{"qr"}));
  EXPECT_EQ(scene.clouds[1].name, "ice");
  EXPECT_EQ(scene.clouds[1].file, folder / "ice.vdb");
  EXPECT_EQ(scene.clouds[1].quantity, "ice_water_content");
  EXPECT_EQ(scene.clouds[1].read.grid, "density");
  EXPECT_EQ(scene.clouds[1].phase_function, 1);
  EXPECT_EQ(scene.phase_functions.size(), 2U);
  EXPECT_THAT(scene.where("cloud.1.quantity"), HasSubstr("scene.toml:11: cloud.1.quantity"));
}

TEST(Scene, MistakesInConstituents) {
  const TemporaryFolder folder;
  folder.write("cloud.vdb", "");
  folder.write("ice.vdb", "");
  const auto message = [&](const std::string& from, const std::string& to,
                           const std::vector<std::string>& overrides = {}) -> std::string {
    std::string text = constituents_toml;
    text.replace(text.find(from), from.size(), to);
    try {
      read_scene(folder.write("scene.toml", text), overrides);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(message("", ""), "no error");
  EXPECT_THAT(message("\"ice\"", "\"liquid\""),
              AllOf(HasSubstr("scene.toml:9: cloud.1.name: already in use"), HasSubstr("liquid")));
  EXPECT_THAT(message("name = \"ice\"\n", ""),
              AllOf(HasSubstr("scene.toml:8: cloud.1.name: missing"), HasSubstr("liquid, ice, rain")));
  EXPECT_THAT(message("\"ice\"", "\"i c e\""), HasSubstr("scene.toml:9: cloud.1.name: not a name"));
  EXPECT_THAT(message("\"isotropic\"", "\"crystals\""),
              AllOf(HasSubstr("scene.toml:14: cloud.1.phase_function: no phase function"), HasSubstr("crystals")));
  EXPECT_THAT(message("\"ice.vdb\"", "\"none.vdb\""), HasSubstr("scene.toml:10: cloud.1.file"));
  EXPECT_THAT(message("[[cloud]]\nname = \"ice\"", "[cloud]"),
              AllOf(HasSubstr("scene.toml:8"), HasSubstr("[cloud] alone, or [[cloud]] for each constituent")));
  EXPECT_THAT(message("[[cloud]]\nname = \"liquid\"", "[cloud]"),
              AllOf(HasSubstr("scene.toml:7"), HasSubstr("[cloud] alone, or [[cloud]] for each constituent")));
  EXPECT_THAT(message("[\"ql\", \"qr\"]", "[\"ql\", \"ql\"]"),
              AllOf(HasSubstr("scene.toml:5: cloud.0.grid"), HasSubstr("twice")));
  EXPECT_THAT(message("[\"ql\", \"qr\"]", "[]"), HasSubstr("scene.toml:5: cloud.0.grid: empty"));
  EXPECT_THAT(message("[\"ql\", \"qr\"]", "[1]"), HasSubstr("scene.toml:5: cloud.0.grid: not a string"));
  EXPECT_THAT(message("", "", {"cloud.scale=2"}), HasSubstr("cloud.scale: no such entry"));
  EXPECT_EQ(message("", "", {"cloud.1.scale=2"}), "no error");
  EXPECT_THAT(message("", "", {"cloud.1.scael=2"}), HasSubstr("cloud.1.scael: unknown key"));
}

TEST(Scene, MomentsAndTablesFromFiles) {
  const TemporaryFolder folder;
  folder.write("moments.txt", "# l chi_l\n0 1\n1 0.5  # first\n\n2 0.25\n");
  folder.write("table.txt", "0 1\n90 1\n180 1\n");
  const std::string text = replaced("type = \"henyey-greenstein\"\nasymmetry_parameter = 0.85",
                                    "type = \"legendre\"\nfile = \"moments.txt\"") +
                           "\n[[layer]]\nbottom_m = 0\ntop_m = 1\noptical_depth = 1\nsingle_scattering_albedo = "
                           "1\nphase_function = \"t\"\n[phase_function.t]\ntype = \"table\"\nfile = \"table.txt\"\n";
  const Scene scene = read_scene(folder.write("scene.toml", text));
  EXPECT_DOUBLE_EQ(scene.phase_functions[0].function.moment(2), 0.25);
  EXPECT_TRUE(scene.phase_functions[0].measured);
  EXPECT_NEAR(scene.phase_functions[2].function.asymmetry_parameter(), 0, 1e-12);  // constant: isotropic

  EXPECT_TRUE(scene.notes.empty());

  folder.write("table.txt", "0 1.005\n90 1.005\n180 1.005\n");
  EXPECT_THAT(read_scene(folder / "scene.toml").notes,
              testing::ElementsAre(AllOf(HasSubstr("phase_function.t.file: "), HasSubstr("off by +0.50 %"))));

  folder.write("moments.txt", "0 1\n2 0.5\n");
  try {
    read_scene(folder / "scene.toml");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("scene.toml:5: phase_function.droplets.file"), HasSubstr("moments.txt"),
                                    HasSubstr("l = 2"), HasSubstr("l = 1")));
  }
  folder.write("moments.txt", "0 1\n1 half\n");
  EXPECT_THROW(read_scene(folder / "scene.toml"), InputError);
}

TEST(Scene, BearingIsClockwiseFromNorth) {
  const TemporaryFolder folder;
  const Scene scene = read_scene(folder.write("scene.toml", replaced("azimuth_deg = 37.0", "bearing_deg = 53.0")));
  EXPECT_DOUBLE_EQ(scene.sun->azimuth_deg, 37);
}

TEST(Scene, Overrides) {
  const TemporaryFolder folder;
  const auto file = folder.write("scene.toml", layers_toml);
  const std::vector<std::string> overrides{"sun.zenith_deg=30", "layer.1.optical_depth=2", "sky.radiance_w_m2_sr=0.5",
                                           "title=a \"new\" title", "layer.0.phase_function=isotropic"};
  const Scene scene = read_scene(file, overrides);
  EXPECT_EQ(scene.sun->zenith_deg, 30);
  EXPECT_EQ(scene.layers[1].optical_depth, 2);
  EXPECT_EQ(scene.sky_radiance, 0.5);
  EXPECT_EQ(scene.title, "a \"new\" title");
  EXPECT_EQ(scene.phase_functions[0].name, "isotropic");
  // The text as run is a scene that says the same.
  const Scene again = read_scene(folder.write("again.toml", scene.text));
  EXPECT_EQ(again.sun->zenith_deg, 30);
  EXPECT_EQ(again.layers[1].optical_depth, 2);
  EXPECT_EQ(again.layers[0].top_m, 1000);
  EXPECT_EQ(again.sky_radiance, 0.5);
  EXPECT_EQ(again.title, scene.title);
  EXPECT_EQ(again.solver.accuracy, "fine");
}

TEST(Scene, EarlierNamesOfKeysAreAccepted) {
  const TemporaryFolder folder;
  const auto file = folder.write("scene.toml", layers_toml);
  for (const char* key : {"max_level_optical_depth", "largest_level_depth"}) {
    const Scene scene = read_scene(file, std::vector<std::string>{std::string("solver.") + key + "=3"});
    EXPECT_EQ(scene.solver.max_level_optical_depth, 3) << key;
  }
  EXPECT_THAT(message_of(layers_toml, {"solver.max_level_optical_depth=3", "solver.largest_level_depth=2"}),
              AllOf(HasSubstr("solver.largest_level_depth"), HasSubstr("earlier name")));
}

TEST(Scene, NamesInMessagesAreOnOneLine) {
  const TemporaryFolder folder;
  const auto file = folder.write("scene.toml", "\"a\\u001b\\n\" = 1\n");
  EXPECT_THAT([&] { read_scene(file); }, testing::ThrowsMessage<InputError>(
                                             AllOf(HasSubstr("\"a\\u001B\\u000A\""), testing::Not(HasSubstr("\n")))));
  const std::vector<std::string> set{"x=\n1"};
  EXPECT_THAT(
      [&] { read_scene(folder.write("slab.toml", layers_toml), set); },
      testing::ThrowsMessage<InputError>(AllOf(HasSubstr("--set \"x=\\u000A1\""), testing::Not(HasSubstr("\n")))));
}

TEST(Scene, WrongOverrides) {
  EXPECT_THAT(message_of(layers_toml, {"sun.zenit_deg=30"}),
              AllOf(HasSubstr("--set sun.zenit_deg=30"), HasSubstr("unknown key"), HasSubstr("mean zenith_deg")));
  EXPECT_THAT(message_of(layers_toml, {"layer.2.optical_depth=1"}), AllOf(HasSubstr("layer.2"), HasSubstr("0 to 1")));
  EXPECT_THAT(message_of(layers_toml, {"layer.x.optical_depth=1"}), HasSubstr("layer.x"));
  EXPECT_THAT(message_of(layers_toml, {"sun.zenith_deg"}), HasSubstr("KEY=VALUE"));
  EXPECT_THAT(message_of(layers_toml, {"sun..zenith_deg=3"}), HasSubstr("KEY=VALUE"));
  EXPECT_THAT(message_of(layers_toml, {"title.x=3"}), HasSubstr("below a value"));
  EXPECT_THAT(message_of(layers_toml, {"sun.zenith_deg=steep"}),
              AllOf(HasSubstr("not a number"), HasSubstr("\"steep\"")));
  EXPECT_THAT(message_of(layers_toml, {"sun.zenith_deg=95"}),
              AllOf(HasSubstr("--set sun.zenith_deg=95"), HasSubstr("90")));
}

struct Mistake {
  const char* name;
  std::string part;
  std::string by;
  std::vector<std::string> words;  ///< that the message must hold
};

class SceneMistake : public testing::TestWithParam<Mistake> {};

TEST_P(SceneMistake, IsTold) {
  const Mistake& mistake = GetParam();
  const std::string message = message_of(replaced(mistake.part, mistake.by));
  EXPECT_THAT(message, HasSubstr("scene.toml"));
  for (const std::string& word : mistake.words) EXPECT_THAT(message, HasSubstr(word));
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(
    Scene, SceneMistake,
    testing::Values(
        Mistake{"unknown_key", "albedo = 0.25", "albdo = 0.25", {":29: surface.albdo", "unknown key", "mean albedo?"}},
        Mistake{"unknown_table", "[surface]", "[surfaces]", {":27: surfaces", "unknown key", "mean surface?"}},
        Mistake{"wrong_type",
                "zenith_deg = 60.0",
                "zenith_deg = \"60\"",
                {":23: sun.zenith_deg", "not a number", "\"60\""}},
        Mistake{"number_as_text", "phase_function = \"rayleigh\"", "phase_function = 3", {":20:", "not a string", "3"}},
        Mistake{"table_as_value", "title = \"three layers\"", "sun = 3", {"sun"}},
        Mistake{"nan", "zenith_deg = 60.0", "zenith_deg = nan", {":23: sun.zenith_deg", "found nan", "0 <= z < 90"}},
        Mistake{"infinity", "top_m = 1000", "top_m = inf", {":10: layer.0.top_m", "found inf"}},
        Mistake{"albedo", "albedo = 0.25", "albedo = 1.2", {":29: surface.albedo", "found 1.2", "0 to 1"}},
        Mistake{"asymmetry", "= 0.85", "= 1.0", {":5: phase_function.droplets.asymmetry_parameter", "-1 < g < 1"}},
        Mistake{"ssa", "= 0.99", "= 1.01", {":12: layer.0.single_scattering_albedo", "found 1.01", "0 to 1"}},
        Mistake{"sun_below_horizon", "zenith_deg = 60.0", "zenith_deg = 90.0", {":23: sun.zenith_deg", "found 90"}},
        Mistake{"azimuth_and_bearing",
                "azimuth_deg = 37.0",
                "azimuth_deg = 37.0\nbearing_deg = 1",
                {":25: sun.bearing_deg", "azimuth_deg"}},
        Mistake{"no_azimuth", "azimuth_deg = 37.0", "", {"sun.azimuth_deg", "neither", "bearing_deg"}},
        Mistake{"missing_key", "optical_depth = 10.0", "", {":7: layer.0.optical_depth", "missing"}},
        Mistake{"negative_optical_depth", "optical_depth = 10.0", "optical_depth = -1", {":11:", "found -1", ">= 0"}},
        Mistake{"layer_upside_down", "top_m = 1000", "top_m = 400", {":10: layer.0.top_m", "found 400", "> 500"}},
        Mistake{"unknown_phase_function",
                "= \"droplets\"",
                "= \"drops\"",
                {":13:", "\"drops\"", "droplets, isotropic, rayleigh"}},
        Mistake{
            "unknown_type", "\"henyey-greenstein\"", "\"henyey\"", {":4:", "\"henyey\"", "double-henyey-greenstein"}},
        Mistake{"set_without_file",
                "type = \"henyey-greenstein\"\nasymmetry_parameter = 0.85",
                "type = \"set\"",
                {"phase_function.droplets.file", "missing"}},
        Mistake{"mie_without_file",
                "type = \"henyey-greenstein\"\nasymmetry_parameter = 0.85",
                "type = \"mie\"",
                {"phase_function.droplets.file", "missing"}},
        Mistake{"redefined", "droplets]", "rayleigh]", {"phase_function.rayleigh", "already defined"}},
        Mistake{
            "surface_type", "\"lambertian\"", "\"snow\"", {":28: surface.type", "\"snow\"", "rpv, ross-li, cox-munk"}},
        Mistake{"surface_key_of_another_type",
                "\"lambertian\"",
                "\"rpv\"",
                {":29: surface.albedo: a key of the type \"lambertian\"", "found type = \"rpv\"",
                 "rho0, k, theta, rho_c; leave albedo out"}},
        Mistake{
            "surface_parameter", "albedo = 0.25", "slope_deg = 95", {":29: surface.slope_deg", "found 95", "0 to 89"}},
        Mistake{"albedo_map_and_albedo",
                "albedo = 0.25",
                "albedo = 0.25\nalbedo_map = \"map.h5\"",
                {":30: surface.albedo_map", "one of the two"}},
        Mistake{"albedo_map_without_cloud",
                "albedo = 0.25",
                "albedo_map = \"map.h5\"",
                {":29: surface.albedo_map", "needs a cloud"}},
        Mistake{"radiance_without_zenith",
                "[solver]",
                "[[radiance]]\nname = \"nadir\"\n[solver]",
                {":31: radiance.0.zenith_deg", "missing"}},
        Mistake{"radiance_on_the_horizon",
                "[solver]",
                "[[radiance]]\nname = \"a\"\nzenith_deg = 90.5\n[solver]",
                {":33: radiance.0.zenith_deg", "90.5", "without 89 to 91"}},
        Mistake{"radiance_name",
                "[solver]",
                "[[radiance]]\nname = \"a/b\"\nzenith_deg = 0\n[solver]",
                {":32: radiance.0.name", "letters, digits"}},
        Mistake{"accuracy",
                "\"fine\"",
                "\"best\"",
                {":32: solver.accuracy", "\"best\"", "draft, balanced, fine, reference"}},
        Mistake{"control_points",
                "accuracy = \"fine\"",
                "control_points = 100",
                {":32: solver.control_points", "100", "162"}},
        Mistake{"directions",
                "accuracy = \"fine\"",
                "directions = \"all\"",
                {":32: solver.directions", "all", "double-gauss"}},
        Mistake{"beam_rays", "accuracy = \"fine\"", "beam_rays = 10", {":32: solver.beam_rays", "not a square"}},
        Mistake{"not_an_integer",
                "accuracy = \"fine\"",
                "max_sweeps = 10.5",
                {":32: solver.max_sweeps", "not an integer", "10.5"}},
        Mistake{"tolerance", "accuracy = \"fine\"", "tolerance = 1e-9", {":32: solver.tolerance", "1e-8 to 0.1"}},
        Mistake{"fields",
                "[solver]",
                "[output]\nfields = [\"flux\"]\n[solver]",
                {":32: output.fields", "\"flux\"", "actinic", "optical_depth"}},
        Mistake{"vertical_cells",
                "[solver]",
                "[domain]\nvertical_cells = 0\n[solver]",
                {":32: domain.vertical_cells", "found 0"}},
        Mistake{"corners",
                "[solver]",
                "[domain]\nmin_m = [0, 0, 5]\nmax_m = [1, 1, 5]\n[solver]",
                {":33: domain.max_m", "in z"}},
        Mistake{"no_such_file",
                "[solver]",
                "[cloud]\nfile = \"none.vdb\"\n[solver]",
                {":32: cloud.file", "no such file", "none.vdb"}},
        Mistake{"directory_as_file", "[solver]", "[cloud]\nfile = \".\"\n[solver]", {":32: cloud.file", "a directory"}},
        Mistake{"not_toml", "albedo = 0.25", "albedo = = 3", {"scene.toml:29:10: not valid TOML"}}),
    [](const auto& test) { return test.param.name; });

TEST(Scene, CloudMistakes) {
  const TemporaryFolder folder;
  folder.write("cloud.vdb", "");
  const std::string good =
      "[cloud]\nfile = \"cloud.vdb\"\nsingle_scattering_albedo = 1\nphase_function = \"isotropic\"\n"
      "[sun]\nzenith_deg = 0\nazimuth_deg = 0\n";
  EXPECT_NO_THROW(read_scene(folder.write("scene.toml", good)));
  const auto message = [&](const std::string& more) {
    try {
      read_scene(folder.write("scene.toml", "[cloud]\n" + more + "\n" + good.substr(good.find("file"))));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(message("scale = -1.0"),
              AllOf(HasSubstr("scene.toml:2: cloud.scale"), HasSubstr("found -1"), HasSubstr("> 0")));
  EXPECT_THAT(message("scale = 0"), HasSubstr("out of range"));
  EXPECT_THAT(message("voxel_size_m = [1, 2]"), AllOf(HasSubstr("voxel_size_m"), HasSubstr("[x, y, z]")));
  EXPECT_THAT(message("voxel_size_m = [1, 2, 0]"), AllOf(HasSubstr("voxel_size_m"), HasSubstr("> 0")));
  EXPECT_THAT(message("up_axis = \"w\""), HasSubstr("x, y, z"));
  EXPECT_THAT(message("quantity = \"density\""), HasSubstr("extinction, liquid_water_content"));
  EXPECT_THAT(message("single_scattering_albedo_grid = \"ssa\""), HasSubstr("one of the two"));
  EXPECT_THAT(message("effective_radius_um = 1\neffective_radius_grid = \"reff\""), HasSubstr("one of the two"));
}

TEST(Scene, WholeScenesThatMakeNoSense) {
  EXPECT_THAT(message_of("[sun]\nzenith_deg = 0\nazimuth_deg = 0\n"),
              AllOf(HasSubstr("[cloud]"), HasSubstr("[[layer]]")));
  EXPECT_THAT(message_of(replaced("irradiance_w_m2 = 1361.0", "irradiance_w_m2 = 0")), HasSubstr("no light"));
  EXPECT_THAT(message_of(""), HasSubstr("neither"));
}

std::string spectral(const std::string& part, const std::string& by) {
  return replaced(part, by) + "[spectrum]\nwavelengths_um = [0.67, 0.55]\n";
}

TEST(Scene, ListsHaveOneNumberAWavelength) {
  const TemporaryFolder folder;
  const auto scenes = [&](const std::string& part, const std::string& by) {
    auto read = read_scenes(folder.write("scene.toml", spectral(part, by)));
    EXPECT_EQ(read.size(), 2u);
    EXPECT_EQ(read.at(0).wavelength_um, 0.67);
    EXPECT_EQ(read.at(1).wavelength_um, 0.55);
    return read;
  };
  EXPECT_EQ(scenes("optical_depth = 10.0", "optical_depth = [10, 11.5]")[1].layers[0].optical_depth, 11.5);
  EXPECT_EQ(scenes("optical_depth = 10.0", "optical_depth = 10")[1].layers[0].optical_depth, 10);
  EXPECT_EQ(scenes("= 0.99", "= [0.9, 1]")[0].layers[0].single_scattering_albedo, 0.9);
  EXPECT_EQ(scenes("albedo = 0.25", "albedo = [0.25, 0.5]")[1].surface.albedo, 0.5);
  EXPECT_EQ(scenes("irradiance_w_m2 = 1361.0", "irradiance_w_m2 = [1.5, 1.9]")[1].sun->irradiance_w_m2, 1.9);
  EXPECT_EQ(scenes("[sun]", "[sky]\nradiance_w_m2_sr = [1, 2]\n[sun]")[1].sky_radiance, 2);
  EXPECT_DOUBLE_EQ(scenes("= 0.85", "= [0.8, 0.85]")[0].phase_functions[0].function.asymmetry_parameter(), 0.8);
}

TEST(Scene, AirFollowsRayleighsLaw) {
  const TemporaryFolder folder;
  const auto scenes = read_scenes(folder.write(
      "scene.toml", spectral("optical_depth = 0.1\n", "optical_depth = 0.1\noptical_depth_wavelength_um = 0.55\n")));
  EXPECT_DOUBLE_EQ(scenes[1].layers[1].optical_depth, 0.1);
  // The fourth power, and 1 % for the dispersion of air.
  EXPECT_NEAR(scenes[0].layers[1].optical_depth / (0.1 * std::pow(0.55 / 0.67, 4)), 1, 0.02);
  EXPECT_LT(scenes[0].layers[1].optical_depth, 0.1 * std::pow(0.55 / 0.67, 4));
}

TEST(Scene, SpectrumMistakes) {
  EXPECT_THAT(message_of(replaced("optical_depth = 10.0", "optical_depth = [1, 2]")),
              AllOf(HasSubstr("layer.0.optical_depth"), HasSubstr("without [spectrum]")));
  EXPECT_THAT(message_of(spectral("optical_depth = 10.0", "optical_depth = [1, 2, 3]")),
              AllOf(HasSubstr("an array of 3"), HasSubstr("a list of 2")));
  EXPECT_THAT(message_of(spectral("optical_depth = 10.0", "optical_depth = [1, -2]")), HasSubstr("-2"));
  EXPECT_THAT(message_of(layers_toml + "[spectrum]\n"), AllOf(HasSubstr("wavelengths_um"), HasSubstr("missing")));
  EXPECT_THAT(message_of(layers_toml + "[spectrum]\nwavelengths_um = []\n"), HasSubstr("empty"));
  EXPECT_THAT(message_of(layers_toml + "[spectrum]\nwavelengths_um = [0.5, 0.5]\n"),
              HasSubstr("neither ascending nor descending"));
  EXPECT_THAT(message_of(layers_toml + "[spectrum]\nwavelengths_um = [0.5, 0]\n"), HasSubstr("> 0"));
  EXPECT_THAT(
      message_of(replaced("optical_depth = 0.1\n", "optical_depth = 0.1\noptical_depth_wavelength_um = 0.55\n")),
      HasSubstr("needs [spectrum]"));
  EXPECT_THAT(message_of(spectral("optical_depth = 10.0", "optical_depth = 10.0\noptical_depth_wavelength_um = 0.55")),
              AllOf(HasSubstr("air alone"), HasSubstr("droplets")));
  EXPECT_THAT(
      message_of(spectral("optical_depth = 0.1\n", "optical_depth = [0.1, 0.2]\noptical_depth_wavelength_um = 0.55\n")),
      HasSubstr("one of the two"));
}

TEST(Scene, FilesThatAreNoScenes) {
  const TemporaryFolder folder;
  const auto message = [](const std::filesystem::path& path) {
    try {
      read_scene(path);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(message(folder / "none.toml"), AllOf(HasSubstr("none.toml"), HasSubstr("no such file")));
  EXPECT_THAT(message(folder / ""), HasSubstr("a directory"));
  EXPECT_THAT(message(folder.write("large.toml", std::string(5 << 20, '\n'))), HasSubstr("at most 4 MB"));
  EXPECT_THAT(message(folder.write("cloud.vdb", std::string(" BDV\0\0\0\0", 8) + std::string(5 << 20, 'x'))),
              AllOf(HasSubstr("found an OpenVDB file"), HasSubstr("file in [cloud]")));
  EXPECT_THAT(message(folder.write("les.nc", "\x89HDF\r\n\x1a\n")),
              AllOf(HasSubstr("netCDF-4 file"), HasSubstr("cloud import")));
  EXPECT_THAT(message(folder.write("les.nc", "CDF\x01")), AllOf(HasSubstr("netCDF file"), HasSubstr("cloud import")));
  EXPECT_THAT(message(folder.write("16.toml", "\xff\xfe[")), AllOf(HasSubstr("UTF-16"), HasSubstr("UTF-8")));
  EXPECT_THAT(message(folder.write("empty.toml", "")), HasSubstr("neither [cloud] nor [[layer]]"));
}

}  // namespace
}  // namespace cloudbow
