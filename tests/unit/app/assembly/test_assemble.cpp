// From scene to problem. Truth: hand-counted grids, the formulas of the scene format.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>

#include <array>
#include <cmath>
#include <filesystem>

#include "app/scene/accuracy.hpp"
#include "cloudbow/app/assemble.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/io/droplet_table_file.hpp"
#include "temporary_folder.hpp"
#include "usual_memory.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// 4 x 3 x 2 cells of 25 m from the origin; one voxel (1, 1, 1) of 0.02.
class AssembleTest : public testing::Test {
 protected:
  AssembleTest() { write_cloud("extinction"); }

  void write_cloud(const std::string& quantity, float value = 0.02f) {
    std::vector<float> dense(24, 0.0f);
    dense[(1 * 3 + 1) * 4 + 1] = value;
    write_cloud_vdb(folder_ / "cloud.vdb", make_cloud_field({4, 3, 2}, {25, 25, 25}, {0, 0, 0}, dense, quantity));
  }

  /// Another one in each voxel, some 0.
  std::vector<float> write_many_extinctions() {
    std::vector<float> dense;
    for (int n = 0; n < 24; ++n) dense.push_back(static_cast<float>(n % 5) / 64);
    write_cloud_vdb(folder_ / "cloud.vdb", make_cloud_field({4, 3, 2}, {25, 25, 16}, {0, 0, 0}, dense, "extinction"));
    return dense;
  }

  AssembledScene assembled(const std::string& more, const std::string& cloud = "single_scattering_albedo = 0.9") {
    const std::string text = "[cloud]\nfile = \"cloud.vdb\"\nphase_function = \"isotropic\"\n" + cloud +
                             "\n[sun]\nzenith_deg = 30\nazimuth_deg = 20\n" + more;
    return assemble(read_scene(folder_.write("scene.toml", text)), memory);
  }
  std::string message(const std::string& more, const std::string& cloud = "single_scattering_albedo = 0.9") {
    try {
      assembled(more, cloud);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  TemporaryFolder folder_;
};

TEST_F(AssembleTest, GridIsTheFilesDomain) {
  const AssembledScene scene = assembled("");
  const BoxGrid& box = scene.problem.grid.box;
  EXPECT_EQ(box.nx, 4);
  EXPECT_EQ(box.ny, 3);
  EXPECT_EQ(box.z_edge_m, (std::vector<double>{0, 25, 50}));
  ASSERT_EQ(scene.problem.grid.active_cells(), 1u);
  EXPECT_FLOAT_EQ(scene.problem.grid.scattering[0][0], 0.018f);
  EXPECT_FLOAT_EQ(scene.problem.grid.absorption[0], 0.002f);
  EXPECT_FALSE(scene.options.double_precision);
}

TEST_F(AssembleTest, DomainGivenByTheScene) {
  const AssembledScene scene =
      assembled("[domain]\nboundary = \"open\"\nmin_m = [-50, 25, -25]\nmax_m = [75, 100.001, 100]\n");
  const BoxGrid& box = scene.problem.grid.box;
  EXPECT_EQ(box.nx, 5);
  EXPECT_EQ(box.ny, 3);
  EXPECT_EQ(box.x_min_m, -50);
  EXPECT_EQ(box.z_edge_m, (std::vector<double>{-25, 25, 50, 100}));
  EXPECT_FALSE(box.periodic);
  EXPECT_EQ(scene.problem.grid.spans.at(0).i, 3);
}

TEST_F(AssembleTest, CamerasAndImagesReachTheSolver) {
  const std::string camera = "[[camera]]\nname = \"c\"\nlook_at_m = [0, 0, 50]\nwidth = 4\nheight = 3\nposition_m = ";
  const AssembledScene scene =
      assembled("[[radiance]]\nname = \"n\"\nzenith_deg = 0\nwidth = 8\nheight = 6\n" + camera + "[-300, 20, 0]\n");
  ASSERT_EQ(scene.options.cameras.size(), 1u);
  EXPECT_EQ(scene.options.cameras[0].position_m, Eigen::Vector3d(-300, 20, 0));
  ASSERT_EQ(scene.options.views.size(), 1u);
  EXPECT_EQ(scene.options.views[0].width, 8);
  EXPECT_EQ(scene.options.views[0].height, 6);
  EXPECT_THAT(message(camera + "[5, 5, -1]\n"),
              AllOf(HasSubstr("scene.toml:13: camera.0.position_m"), HasSubstr("below the ground"), HasSubstr("-1 m")));
}

TEST_F(AssembleTest, FilesAreReadOnceForAllWavelengths) {
  const std::string text =
      "[spectrum]\nwavelengths_um = [0.67, 0.55]\n[cloud]\nfile = \"cloud.vdb\"\nphase_function = \"isotropic\"\n"
      "single_scattering_albedo = [0.9, 0.5]\nscale = [1, 2]\n[sun]\nzenith_deg = 30\nazimuth_deg = 20\n";
  const std::vector<Scene> scenes = read_scenes(folder_.write("scene.toml", text));
  CloudFiles files(true);
  EXPECT_FLOAT_EQ(assemble(scenes[0], memory, files, {}).problem.grid.scattering[0][0], 0.018f);
  EXPECT_FLOAT_EQ(assemble(scenes[1], memory, files, {}).problem.grid.scattering[0][0], 0.02f);
  std::filesystem::remove(folder_ / "cloud.vdb");
  EXPECT_FLOAT_EQ(assemble(scenes[0], memory, files, {}).problem.grid.scattering[0][0], 0.018f);
}

TEST_F(AssembleTest, DomainMistakesNameTheNearestNumbers) {
  const auto domain = [&](const std::string& corner) { return message("[domain]\n" + corner + "\n"); };
  EXPECT_THAT(domain("max_m = [110, 75, 50]"), AllOf(HasSubstr("scene.toml:9: domain.max_m"), HasSubstr("in x"),
                                                     HasSubstr("110"), HasSubstr("100 m or 125 m")));
  EXPECT_THAT(domain("min_m = [0, 0, -30]"), AllOf(HasSubstr("in z"), HasSubstr("-50 m or -25 m")));
  EXPECT_THAT(domain("min_m = [50, 0, 0]"),
              AllOf(HasSubstr("cuts the cloud"), HasSubstr("found 50"), HasSubstr("at most 25 m")));
  EXPECT_THAT(domain("max_m = [100, 25, 50]"), AllOf(HasSubstr("cuts the cloud in y"), HasSubstr("at least 50 m")));
  EXPECT_THAT(domain("min_m = [100, 0, 0]"), HasSubstr("domain.min_m"));
  EXPECT_THAT(domain("max_m = [1e12, 75, 50]"), HasSubstr("too far away"));
}

TEST_F(AssembleTest, LayersWidenTheDomain) {
  const std::string layer =
      "[[layer]]\nbottom_m = -10\ntop_m = 333\noptical_depth = 0.01\nsingle_scattering_albedo = 1\nphase_function = "
      "\"rayleigh\"\n";
  EXPECT_EQ(assembled(layer).problem.grid.box.z_edge_m, (std::vector<double>{-10, 25, 50, 333}));
  EXPECT_THAT(message(layer + "[domain]\nmax_m = [100, 75, 50]\n"),
              AllOf(HasSubstr("scene.toml:10: layer.0.top_m"), HasSubstr("found 333"), HasSubstr("50")));
  // A layer's edge is a corner as good as a voxel face.
  EXPECT_EQ(assembled(layer + "[domain]\nmax_m = [100, 75, 333]\n").problem.grid.box.z_edge_m.back(), 333);
}

TEST_F(AssembleTest, DropletsFromLiquidWater) {
  // 3 LWC / (2 rho_w r_e): 0.02 g/m3 of 10 um droplets extinguish 0.003 1/m.
  write_cloud("");
  const AssembledScene scene =
      assembled("", "quantity = \"liquid_water_content\"\neffective_radius_um = 10\nsingle_scattering_albedo = 1");
  EXPECT_FLOAT_EQ(scene.problem.grid.scattering[0][0], 0.003f);
  EXPECT_THAT(message("", "quantity = \"liquid_water_content\"\nsingle_scattering_albedo = 1"),
              AllOf(HasSubstr("effective_radius_um"), HasSubstr("missing")));
}

/// A map of 1 x 2 values, albedos of .1 and .7 if no others are given, at these places along x.
void write_map(const std::filesystem::path& file, std::array<double, 2> x, const std::string& units,
               const char* name = "albedo", const std::array<float, 2>& value = {.1F, .7F}) {
  int id = 0, y_dimension = 0, x_dimension = 0, coordinate = 0, variable = 0;
  ASSERT_EQ(nc_create(file.c_str(), NC_CLOBBER, &id), NC_NOERR);
  nc_def_dim(id, "y", 1, &y_dimension);
  nc_def_dim(id, "x", 2, &x_dimension);
  nc_def_var(id, "x", NC_DOUBLE, 1, &x_dimension, &coordinate);
  nc_put_att_text(id, coordinate, "units", units.size(), units.c_str());
  const std::array<int, 2> dimensions{y_dimension, x_dimension};
  nc_def_var(id, name, NC_FLOAT, 2, dimensions.data(), &variable);
  nc_enddef(id);
  nc_put_var_double(id, coordinate, x.data());
  nc_put_var_float(id, variable, value.data());
  nc_close(id);
}

// Two parts of four columns each. In metres the map has the size of the domain, 100 m.
TEST_F(AssembleTest, MapsOfAlbedoCoverTheDomain) {
  const auto row = [&] { return assembled("[surface]\nalbedo_map = \"map.nc\"\n").problem.surface.albedo_map; };
  const auto expect_row = [&](float west, float east) {
    const std::vector<float> albedo = row();
    ASSERT_EQ(albedo.size(), 12u);
    for (std::size_t n = 0; n < albedo.size(); ++n) EXPECT_FLOAT_EQ(albedo[n], n % 4 < 2 ? west : east);
  };
  write_map(folder_ / "map.nc", {25, 75}, "m");
  expect_row(.1F, .7F);
  write_map(folder_ / "map.nc", {4000.075, 4000.025}, "km");  // from elsewhere, and turned
  expect_row(.7F, .1F);
  write_map(folder_ / "map.nc", {8, 9}, "degrees_east");  // of no known length
  expect_row(.1F, .7F);
  write_map(folder_ / "map.nc", {25, 1025}, "m");
  EXPECT_THAT(message("[surface]\nalbedo_map = \"map.nc\"\n"),
              AllOf(HasSubstr("scene.toml:9: surface.albedo_map"), HasSubstr("map.nc"),
                    HasSubstr("found 2000 m along x"), HasSubstr("allowed 100 m"), HasSubstr("cut the map")));
}

TEST_F(AssembleTest, QuantitiesThatContradictTheFileAreErrors) {
  const std::string water =
      "quantity = \"liquid_water_content\"\neffective_radius_um = 10\nsingle_scattering_albedo = 1";
  const std::string extinction = "quantity = \"extinction\"\nsingle_scattering_albedo = 1";
  EXPECT_THAT(message("", water), AllOf(HasSubstr("scene.toml:4: cloud.quantity"), HasSubstr("contradicts"),
                                        HasSubstr("metadata say extinction); leave the key out")));
  for (const char* quantity : {"effective_radius", "absorbed_power"}) {
    write_cloud(quantity);
    EXPECT_THAT(message("", water), HasSubstr("contradicts"));
    EXPECT_THAT(message("", extinction), HasSubstr("contradicts"));
  }
  write_cloud("liquid_water_content");
  EXPECT_THAT(message("", extinction), AllOf(HasSubstr("contradicts"), HasSubstr("effective_radius_um")));
  // A scale makes extinction of water: 150 m2/kg, droplets of 10 um. 1.5 / (0.1 um) is the most that a radius gives.
  EXPECT_FLOAT_EQ(assembled("", extinction + "\nscale = 0.15").problem.grid.scattering[0][0], 0.003f);
  EXPECT_THAT(message("", extinction + "\nscale = 15.1"), HasSubstr("contradicts"));
  EXPECT_THAT(message("", extinction + "\nscale = 2e-4"), HasSubstr("contradicts"));
}

TEST_F(AssembleTest, RadiiOfNoDropletAreErrors) {
  write_cloud("liquid_water_content");
  for (const char* radius : {"1e-05", "0.09", "5001"}) {
    EXPECT_THAT(
        message("", std::string("single_scattering_albedo = 1\neffective_radius_um = ") + radius),
        AllOf(HasSubstr("scene.toml:5: cloud.effective_radius_um"), HasSubstr(radius), HasSubstr("0.1 to 5000 um")));
  }
  const CloudField water = make_cloud_field({1, 1, 1}, {25, 25, 25}, {0, 0, 0}, {1}, "liquid_water_content");
  write_cloud_vdb(folder_ / "cloud.vdb", water, {}, {{"reff", "effective_radius", "m", {1e-5f}}});
  EXPECT_THAT(message("", "single_scattering_albedo = 1\neffective_radius_grid = \"reff\""),
              AllOf(HasSubstr("grid \"reff\""), HasSubstr("found 1e-05"), HasSubstr("0.1 to 5000 um")));
}

// One voxel of 25 m and 0.02 g/m3 among 12 columns; droplets of 10 um.
TEST_F(AssembleTest, FiguresOfTheCloud) {
  write_cloud("liquid_water_content");
  const AssembledScene scene = assembled("", "effective_radius_um = 10\nsingle_scattering_albedo = 1");
  ASSERT_EQ(scene.clouds.size(), 1U);
  EXPECT_NEAR(scene.clouds[0].water_path_g_m2->sum, 0.5, 1e-7);
  EXPECT_NEAR(scene.clouds[0].optical_depth.largest, 0.075, 1e-8);
  EXPECT_EQ(*scene.clouds[0].effective_radius_um, (std::array<double, 2>{10, 10}));
}

// The domain begins 2 columns before the cloud's box in x and 1 column within it in y. The voxel has .02 times 25 m.
TEST_F(AssembleTest, OpticalDepthOfTheCloudByColumn) {
  const std::string wanted = "[output]\nfields = [\"fluxes\", \"optical_depth\"]\n";
  const std::string layer =
      "[[layer]]\nbottom_m = 0\ntop_m = 50\noptical_depth = 3\nsingle_scattering_albedo = 1\n"
      "phase_function = \"rayleigh\"\n";
  const std::string domain = "[domain]\nmin_m = [-50, 25, 0]\nmax_m = [75, 100, 50]\n";
  std::vector<float> expected(15, 0.F);
  expected[3] = .5F;
  EXPECT_EQ(assembled(wanted + layer + domain).cloud_optical_depth, expected);
  std::vector<float> of_file(12, 0.F);
  of_file[1 * 4 + 1] = .5F;
  EXPECT_EQ(assembled(wanted).cloud_optical_depth, of_file);
  EXPECT_THAT(assembled("").cloud_optical_depth, testing::IsEmpty());
}

/// Sums over the levels of extinction times thickness.
std::vector<double> column_sums(const AssembledScene& scene) {
  const BoxGrid& box = scene.problem.grid.box;
  std::vector<double> depth(box.columns(), 0.);
  for (std::size_t n = 0; n < scene.cloud_extinction.size(); ++n) {
    const auto level = static_cast<int>(n / box.columns());
    depth[n % box.columns()] += static_cast<double>(scene.cloud_extinction[n]) * box.thickness_m(level);
  }
  return depth;
}

// As above. The edges of a layer cut planes of voxels, and levels without cloud lie below and above.
TEST_F(AssembleTest, ExtinctionOfTheCloudByCell) {
  const std::string wanted = "[output]\nfields = [\"optical_depth\", \"extinction\"]\n";
  const std::string layer =
      "[[layer]]\nbottom_m = 7\ntop_m = 33\noptical_depth = 3\nsingle_scattering_albedo = 1\n"
      "phase_function = \"rayleigh\"\n";
  for (const char* const domain : {"[domain]\nmin_m = [-50, 25, 0]\nmax_m = [75, 100, 50]\n", ""}) {
    const AssembledScene scene = assembled(wanted + layer + domain);
    const BoxGrid& box = scene.problem.grid.box;
    ASSERT_EQ(scene.cloud_extinction.size(), box.columns() * static_cast<std::size_t>(box.nz()));
    const std::vector<double> depth = column_sums(scene);
    for (std::size_t c = 0; c < depth.size(); ++c)
      EXPECT_NEAR(depth[c], scene.cloud_optical_depth[c], 1e-6) << "float, column " << c;
    for (const float extinction : scene.cloud_extinction) EXPECT_TRUE(extinction == 0 || extinction == .02F);
  }
  EXPECT_THAT(assembled("").cloud_extinction, testing::IsEmpty());
}

// Without layers all matter is the cloud's.
TEST_F(AssembleTest, ExtinctionIsThatOfTheCells) {
  write_many_extinctions();
  const AssembledScene scene =
      assembled("[output]\nfields = [\"extinction\"]\n", "single_scattering_albedo = 0.5\nscale = 2");
  const OpticalGrid& grid = scene.problem.grid;
  std::size_t places = 0;
  grid.for_each_place([&](int k, std::size_t column, std::size_t cell) {
    EXPECT_EQ(scene.cloud_extinction[static_cast<std::size_t>(k) * 12 + column], grid.extinction(cell));
    ++places;
  });
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count_if(scene.cloud_extinction, [](float e) { return e > 0; })),
            places);
}

// Sums of extinction times thickness over unlike levels; their sum is the figure of the dry run.
TEST_F(AssembleTest, OpticalDepthSumsTheLevels) {
  const std::vector<float> dense = write_many_extinctions();
  const AssembledScene scene =
      assembled("[output]\nfields = [\"optical_depth\"]\n", "single_scattering_albedo = 0.5\nscale = 2");
  ASSERT_EQ(scene.cloud_optical_depth.size(), 12U);
  double sum = 0;
  for (std::size_t c = 0; c < 12; ++c) {
    EXPECT_EQ(scene.cloud_optical_depth[c], 2 * 16 * (dense[c] + dense[12 + c])) << "powers of two are exact";
    sum += scene.cloud_optical_depth[c];
  }
  EXPECT_EQ(scene.clouds[0].optical_depth.sum, sum);
}

TEST_F(AssembleTest, DoubtsAndNotesAreToldOnce) {
  std::vector<std::string> told;
  CloudFiles files(false, [&](const std::string& sentence) { told.push_back(sentence); });
  write_cloud("liquid_water_content", 2005);
  const auto scene = read_scene(
      folder_.write("scene.toml",
                    "[cloud]\nfile = \"cloud.vdb\"\nphase_function = \"isotropic\"\nsingle_scattering_albedo = 1\n"
                    "effective_radius_um = 0.1\n[sun]\nzenith_deg = 30\nazimuth_deg = 20\n"));
  for (int n = 0; n < 2; ++n) assemble(scene, memory, files, {});
  EXPECT_THAT(told, testing::ElementsAre(AllOf(HasSubstr("warning: "), HasSubstr("2005 g/m3")),
                                         AllOf(HasSubstr("warning: "), HasSubstr("optical depth 7.519e+05"))));
}

// Extinction with a phase function of its own does not need radii: a note is printed, and the grid may be absent.
TEST_F(AssembleTest, ARadiusThatNothingUsesIsTold) {
  write_cloud("extinction");
  for (const std::string key : {"effective_radius_um = 7", "effective_radius_grid = \"nowhere\""}) {
    std::vector<std::string> told;
    CloudFiles files(false, [&](const std::string& sentence) { told.push_back(sentence); });
    const Scene scene = read_scene(folder_.write(
        "scene.toml", "[cloud]\nfile = \"cloud.vdb\"\nphase_function = \"isotropic\"\nsingle_scattering_albedo = 1\n" +
                          key + "\n[sun]\nzenith_deg = 30\nazimuth_deg = 20\n"));
    const AssembledScene assembled = assemble(scene, memory, files, {});
    EXPECT_THAT(told, testing::ElementsAre(AllOf(HasSubstr("cloud.effective_radius"), HasSubstr("not used"))));
    EXPECT_FALSE(assembled.clouds.at(0).effective_radius_um);
  }
}

/// The same cloud with droplets by a table: radii 5 and 10 um, extinctions 0.4 and 0.1 m2/g, albedos 0.5 and 1.
class MieSceneTest : public AssembleTest {
 protected:
  MieSceneTest() {
    write_droplet_table(folder_ / "drops.h5",
                        {0.67, {5, 10}, {0.4, 0.1}, {0.5, 1}, {{1, 0.4, 0.1, 0.008}, {1, 0.2, 0.05, 0.002}}},
                        {{1.33, 0}, "", 1, "gamma", 0.1, "", ""});
  }

  AssembledScene mie(const std::string& cloud, const std::string& phase_function = "", const std::string& more = "") {
    const std::string text = "[cloud]\nfile = \"cloud.vdb\"\nphase_function = \"drops\"\n" + cloud +
                             "\n[phase_function.drops]\ntype = \"mie\"\nfile = \"drops.h5\"\n" + phase_function +
                             "\n[sun]\nzenith_deg = 30\nazimuth_deg = 20\n" + more;
    return assemble(read_scene(folder_.write("scene.toml", text)), memory);
  }
  std::string mie_message(const std::string& cloud, const std::string& phase_function = "",
                          const std::string& more = "") {
    try {
      mie(cloud, phase_function, more);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
};

// 0.02 g/m3 times the table's extinction and albedo; the phase function is the row's.
TEST_F(MieSceneTest, DropletsOfOneRadius) {
  const std::string water = "quantity = \"liquid_water_content\"\n";
  write_cloud("");
  for (const auto& [cloud, phase] : {std::pair<std::string, std::string>{"effective_radius_um = 5", ""},
                                     {"", "effective_radius_um = 5"},
                                     {"effective_radius_um = 5", "effective_radius_um = 5"}}) {
    const OpticalGrid grid = mie(water + cloud, phase).problem.grid;
    EXPECT_FLOAT_EQ(grid.scattering[0][0], 0.02f * 0.4f * 0.5f);
    EXPECT_FLOAT_EQ(grid.absorption[0], 0.02f * 0.4f * 0.5f);
  }
  write_cloud("extinction");
  const AssembledScene scene = mie("effective_radius_um = 10");  // the file's quantity: extinction
  EXPECT_FLOAT_EQ(scene.problem.grid.scattering[0][0], 0.02f);
  EXPECT_EQ(scene.problem.grid.absorption[0], 0);
  EXPECT_EQ(scene.problem.phase[0].moment(1), 0.2);
  // Values in the scene itself take precedence over the table.
  EXPECT_FLOAT_EQ(mie("effective_radius_um = 10\nsingle_scattering_albedo = 0.75").problem.grid.absorption[0], 0.005f);
}

TEST_F(MieSceneTest, LayersTakeTheTablesAlbedo) {
  const std::string layer = "[[layer]]\nbottom_m = 0\ntop_m = 25\noptical_depth = 2\nphase_function = \"drops\"\n";
  const OpticalGrid grid = mie("", "effective_radius_um = 5", layer).problem.grid;
  EXPECT_NEAR(grid.layer_absorption[0], 0.5 * 2 / 25, 1e-12);
  EXPECT_NEAR(grid.layer_scattering[0][0], 0.5 * 2 / 25, 1e-12);
  EXPECT_THAT(mie_message("effective_radius_um = 5", "", layer),
              AllOf(HasSubstr("layer.0.phase_function"), HasSubstr("phase_function.drops.effective_radius_um")));
}

// Voxel by voxel: two voxels of 5 and 6.667 um, the latter an even mixture by mass: extinction 0.25 m2/g, scattering
// 0.1 of the first and 0.05 of the second row (DropletTable.BetweenRowsStandsTheirMixture).
TEST_F(MieSceneTest, DropletsOfTheVoxelsRadius) {
  const std::string cloud = "grid = \"reff\"\nquantity = \"liquid_water_content\"\neffective_radius_grid = \"reff\"";
  const float mixed = 1 / (0.5f / 5 + 0.5f / 10);
  write_cloud_vdb(folder_ / "cloud.vdb", make_cloud_field({2, 1, 1}, {25, 25, 25}, {0, 0, 0}, {5.0f, mixed}, ""),
                  {"reff", false});
  const AssembledScene scene = mie(cloud);  // the radii serve as water contents too
  const OpticalGrid& grid = scene.problem.grid;
  ASSERT_EQ(scene.problem.phase.size(), 2u);
  EXPECT_EQ(scene.problem.phase[0].moment(1), 0.4);
  EXPECT_EQ(scene.problem.phase[1].moment(1), 0.2);
  EXPECT_FLOAT_EQ(grid.scattering[0][0], 5 * 0.4f * 0.5f);
  EXPECT_EQ(grid.scattering[1][0], 0);
  EXPECT_FLOAT_EQ(grid.absorption[0], 5 * 0.4f * 0.5f);
  EXPECT_FLOAT_EQ(grid.scattering[0][1], mixed * 0.1f);
  EXPECT_FLOAT_EQ(grid.scattering[1][1], mixed * 0.05f);
  EXPECT_FLOAT_EQ(grid.absorption[1], mixed * 0.1f);

  write_cloud_vdb(folder_ / "cloud.vdb", make_cloud_field({2, 1, 1}, {25, 25, 25}, {0, 0, 0}, {5.0f, 11.0f}, ""),
                  {"reff", false});
  EXPECT_THAT(mie_message(cloud), AllOf(HasSubstr("11"), HasSubstr("10")));
}

// A table at each of two wavelengths, as two files and as one.
TEST_F(MieSceneTest, SpectraTakeTheTableOfTheWavelength) {
  DropletTable red = read_droplet_table(folder_ / "drops.h5"), blue = red;
  blue.wavelength_um = 0.45;
  blue.single_scattering_albedo = {0.75, 1};
  write_droplet_table(folder_ / "blue.h5", blue, {});
  write_droplet_tables(folder_ / "both.h5", std::vector{blue, red}, std::vector<DropletTableInfo>(2));
  const auto absorption = [&](const std::string& keys) {
    const std::string text =
        "[spectrum]\nwavelengths_um = [0.67, 0.45]\n[cloud]\nfile = \"cloud.vdb\"\neffective_radius_um = 5\n"
        "phase_function = \"d\"\n[phase_function.d]\ntype = \"mie\"\n" +
        keys + "\n[sun]\nzenith_deg = 30\nazimuth_deg = 20\n";
    const auto scenes = read_scenes(folder_.write("scene.toml", text));
    EXPECT_EQ(scenes.size(), 2U);
    return std::array{assemble(scenes[0], memory).problem.grid.absorption[0],
                      assemble(scenes[1], memory).problem.grid.absorption[0]};
  };
  EXPECT_THAT(absorption("file = \"both.h5\""), testing::ElementsAre(0.01F, 0.005F));
  EXPECT_THAT(absorption("file = [\"drops.h5\", \"blue.h5\"]"), testing::ElementsAre(0.01F, 0.005F));
  EXPECT_THAT(absorption("file = \"drops.h5\"\nwavelength_um = 0.67"), testing::ElementsAre(0.01F, 0.01F));
  try {
    absorption("file = \"drops.h5\"");
    ADD_FAILURE() << "a table of another wavelength was taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("drops.h5"), HasSubstr("0.45"), HasSubstr("0.67")));
  }
}

TEST_F(MieSceneTest, SaysWhatIsWrong) {
  EXPECT_THAT(mie_message(""), AllOf(HasSubstr("cloud.effective_radius_um"), HasSubstr("missing"),
                                     HasSubstr("phase_function.drops.effective_radius_um")));
  EXPECT_THAT(mie_message("effective_radius_um = 5", "effective_radius_um = 6"),
              AllOf(HasSubstr("scene.toml:4: cloud.effective_radius_um"), HasSubstr("found 5"), HasSubstr("6")));
  EXPECT_THAT(mie_message("effective_radius_grid = \"reff\"", "effective_radius_um = 6"), HasSubstr("one of the two"));
  EXPECT_THAT(mie_message("effective_radius_um = 20"),
              AllOf(HasSubstr("scene.toml:4: cloud.effective_radius_um"), HasSubstr("found 20"), HasSubstr("5 to 10")));
  EXPECT_THAT(mie_message("", "effective_radius_um = 20"),
              AllOf(HasSubstr("phase_function.drops.effective_radius_um"), HasSubstr("5 to 10")));
  EXPECT_THAT(mie_message("effective_radius_um = 5", "wavelength_um = 0.5"),
              AllOf(HasSubstr("scene.toml:7: phase_function.drops.file"), HasSubstr("drops.h5"), HasSubstr("0.67")));
  folder_.write("drops.h5", "not a table");
  EXPECT_THAT(mie_message("effective_radius_um = 5"),
              AllOf(HasSubstr("phase_function.drops.file"), HasSubstr("not a table of droplets")));
}

// Voxel by voxel a function of a set: scattering 0.02 times the voxel's albedo goes to the voxel's own function, sorted
// by asymmetry parameter.
class PhaseSetTest : public AssembleTest {
 protected:
  PhaseSetTest() {
    folder_.write("set.csv", "# three functions\nl,a,b,c\n0,1,1,1\n1,0.4,0.2,0.3\n2,0.1,0.05,0.08\n");
    write(std::vector<float>{1, 3, 2, 3});
  }
  void write(const std::vector<float>& index) {
    const CloudField field =
        make_cloud_field({4, 1, 1}, {25, 25, 25}, {0, 0, 0}, {0.02f, 0.02f, 0.02f, 0.02f}, "extinction");
    write_cloud_vdb(folder_ / "cloud.vdb", field, {},
                    {{"phase_index", "phase_index", "1", index}, {"albedo", "", "1", {0.5f, 1, 1, 0.75f}}});
  }
  AssembledScene with_set(const std::string& more = "") {
    const std::string text =
        "[cloud]\nfile = \"cloud.vdb\"\nphase_function = \"drops\"\nsingle_scattering_albedo_grid = \"albedo\"\n"
        "[phase_function.drops]\ntype = \"set\"\nfile = \"set.csv\"\n[sun]\nzenith_deg = 30\nazimuth_deg = 20\n" +
        more;
    return assemble(read_scene(folder_.write("scene.toml", text)), memory);
  }
  std::string set_message(const std::string& more = "") {
    try {
      with_set(more);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(PhaseSetTest, VoxelsTakeTheirOwnFunction) {
  const AssembledScene scene = with_set("[solver]\nclass_tolerance = 0");
  ASSERT_EQ(scene.problem.phase.size(), 3u);
  EXPECT_EQ(scene.problem.phase[0].moment(1), 0.2);
  EXPECT_EQ(scene.problem.phase[1].moment(1), 0.3);
  EXPECT_EQ(scene.problem.phase[2].moment(1), 0.4);
  const auto& scattering = scene.problem.grid.scattering;
  EXPECT_EQ(scattering[0], (std::vector<float>{0, 0, 0.02f, 0}));
  EXPECT_EQ(scattering[1], (std::vector<float>{0, 0.02f, 0, 0.015f}));
  EXPECT_EQ(scattering[2], (std::vector<float>{0.01f, 0, 0, 0}));
  ASSERT_TRUE(scene.phase_classes);
  EXPECT_EQ(scene.phase_classes->functions, 3);
  EXPECT_EQ(scene.phase_classes->classes, 3);
  EXPECT_EQ(scene.phase_classes->estimated_error, 0);
}

TEST_F(PhaseSetTest, ClassesKeepScatteringAndAsymmetry) {
  const AssembledScene scene = with_set("[solver]\nclass_tolerance = 0.1");
  ASSERT_EQ(scene.problem.phase.size(), 2u);  // 0.3 lies halfway between 0.2 and 0.4
  const auto& scattering = scene.problem.grid.scattering;
  EXPECT_FLOAT_EQ(scattering[0][1], 0.01f);
  EXPECT_FLOAT_EQ(scattering[1][1], 0.01f);
  EXPECT_FLOAT_EQ(scattering[0][3] + scattering[1][3], 0.015f);
  EXPECT_GT(scene.phase_classes->estimated_error, 0);
}

TEST_F(PhaseSetTest, SaysWhatIsWrong) {
  EXPECT_THAT(set_message("[[layer]]\nbottom_m = 0\ntop_m = 25\noptical_depth = 2\nphase_function = \"drops\"\n"),
              AllOf(HasSubstr("layer.0.phase_function"), HasSubstr("a set")));
  write({1, 4, 2, 3});
  EXPECT_THAT(set_message(), AllOf(HasSubstr("phase_index"), HasSubstr("value 4"), HasSubstr("1 to 3")));
  write({1, 1.5f, 2, 3});
  EXPECT_THAT(set_message(), AllOf(HasSubstr("phase_index"), HasSubstr("1.5"), HasSubstr("whole numbers")));
  for (const auto& [text, words] : {std::pair<std::string, std::string>{"l,a\n0,1\n1,2.4\n", "without the factor 2l+1"},
                                    {"0,1\n1,0.8,0.3\n", ":2: 3 numbers"},
                                    {"0,1\n2,0.8\n", "found l = 2, allowed 1"},
                                    {"0,0.9\n1,0.8\n", "moment 0 of function 1"},
                                    {"0,1\n1,nan\n", "not numbers"},
                                    {"0,1,1\n1,0.1,0.8\n", "function 2: phase function: negative (found -1.4 at 180"},
                                    {"nothing here\n", "too few rows"}}) {
    folder_.write("set.csv", text);
    EXPECT_THAT(set_message(), AllOf(HasSubstr("set.csv"), HasSubstr(words)));
  }
}

TEST_F(AssembleTest, QuantityMustBeSaid) {
  std::vector<float> dense{1.0f};
  write_cloud_vdb(folder_ / "cloud.vdb", make_cloud_field({1, 1, 1}, {25, 25, 25}, {0, 0, 0}, dense, ""));
  EXPECT_THAT(message(""), AllOf(HasSubstr("cloud.quantity"), HasSubstr("extinction, liquid_water_content")));
  EXPECT_TRUE(assembled("", "quantity = \"extinction\"\nsingle_scattering_albedo = 1").options.double_precision);
}

TEST_F(AssembleTest, FluxLevelsAtHeights) {
  const AssembledScene scene = assembled("[output]\nflux_levels = [10.0, 25.0, 50.0]\n");
  EXPECT_EQ(scene.problem.grid.box.z_edge_m, (std::vector<double>{0, 10, 25, 50}));
  EXPECT_EQ(scene.options.listed_levels, (std::vector<int>{1, 2, 3}));
  EXPECT_THAT(message("[output]\nflux_levels = [60.0]\n"),
              AllOf(HasSubstr("scene.toml:9: output.flux_levels"), HasSubstr("found 60"), HasSubstr("0 m to 50 m")));
}

TEST_F(AssembleTest, TooLargeForMemoryIsToldBefore) {
  EXPECT_THAT(message("[domain]\nmax_m = [2500000, 2500000, 50]\n[[layer]]\nbottom_m = 0\ntop_m = 50\noptical_depth = "
                      "1\nsingle_scattering_albedo = 1\nphase_function = \"rayleigh\"\n"),
              HasSubstr("memory"));
}

TEST_F(AssembleTest, SettingsOverrideTheLadder) {
  const SolverOptions options =
      assembled("[solver]\naccuracy = \"draft\"\ndelta_m_order = 7\ntolerance = 0.01\nmode = \"independent-columns\"\n")
          .options;
  EXPECT_EQ(options.control_points, 42);
  EXPECT_EQ(options.fit.delta_m_order, 7);
  EXPECT_EQ(options.fit.beam_delta_m_order, 9);  // stays as far above as in the ladder
  EXPECT_EQ(options.tolerance, 0.01);
  EXPECT_TRUE(options.independent_columns);
}

TEST(Accuracy, ColumnsAreSolvedInDoubleAndFineOnesWithTheirOwnDirections) {
  EXPECT_TRUE(accuracy_options("balanced", HorizontalExtent::column, false).double_precision);
  EXPECT_EQ(accuracy_options("balanced", HorizontalExtent::column, false).directions, "reduced-double-gauss-12x20");
  EXPECT_EQ(accuracy_options("fine", HorizontalExtent::field, false).directions, "double-gauss-12x24");
  EXPECT_EQ(accuracy_options("fine", HorizontalExtent::slice, false).directions, "double-gauss-16x24");
  EXPECT_EQ(accuracy_options("draft", HorizontalExtent::slice, false).directions, "double-gauss-6x8");
  EXPECT_EQ(accuracy_options("fine", HorizontalExtent::column, false).directions, "double-gauss-16x24");
  EXPECT_EQ(accuracy_options("fine", HorizontalExtent::column, true).fit.beam_delta_m_order, 16);
}

const std::string air = "[atmosphere]\nheight_m = [0, 1000]\ntemperature_k = [290, 280]\nstandard = \"us-1976\"\n";

// The voxel is from 25 to 50 m: the air in its middle has 289.625 K. A grid gives it another temperature.
TEST_F(AssembleTest, TemperaturesBecomePlanckRadiances) {
  const PlanckFunction planck = PlanckFunction::at(10.8);
  const std::string thermal = air + "[thermal]\nwavelength_um = 10.8\n";
  const std::string emission = "irradiance_w_m2 = 0\n" + thermal + "[surface]\ntemperature_k = 300\n";
  const Problem of_air = assembled(emission).problem;
  ASSERT_TRUE(of_air.emits());
  ASSERT_EQ(of_air.grid.planck.size(), 1U);
  constexpr double rounding = 1e-6;  // of floats, and B is not quite linear in a voxel
  EXPECT_NEAR(of_air.grid.planck[0] / planck(289.625), 1, rounding);
  EXPECT_NEAR(of_air.grid.planck_step[0] / (planck(289.5) - planck(289.75)), 1, 1e-3);
  EXPECT_EQ(of_air.surface.planck, planck(300));

  CloudField field = make_cloud_field(
      {4, 3, 2}, {25, 25, 25}, {0, 0, 0},
      [] {
        std::vector<float> dense(24, 0.F);
        dense[(1 * 3 + 1) * 4 + 1] = .02F;
        return dense;
      }(),
      "extinction");
  write_cloud_vdb(folder_ / "cloud.vdb", field, {}, {{"T", "temperature", "K", {275.F}}, {"C", "", "", {2.F}}});
  const std::string cloud = "single_scattering_albedo = 0.9\ntemperature_grid = ";
  const AssembledScene of_grid = assembled(emission, cloud + "\"T\"");
  EXPECT_NEAR(of_grid.problem.grid.planck[0] / planck(275), 1, rounding);
  EXPECT_EQ(of_grid.clouds.at(0).temperature_k, (std::array<double, 2>{275, 275}));
  EXPECT_THAT(message(emission, cloud + "\"C\""),
              AllOf(HasSubstr("scene.toml:5: cloud.temperature_grid"), HasSubstr("has the value 2 (150 to 350")));
  EXPECT_THAT(message(emission, cloud + "\"absent\""), AllOf(HasSubstr("temperature_grid"), HasSubstr("absent")));
  EXPECT_THAT(message("", cloud + "\"T\""), HasSubstr("nothing emits without [thermal]"));
  EXPECT_THAT(
      message("irradiance_w_m2 = 0\n" + air + "[thermal]\nwavelength_um = 0.2\n[surface]\ntemperature_k = 300\n"),
      HasSubstr("nothing emits in this spectral interval"));
}

TEST_F(AssembleTest, MapsOfTemperatureAreMeansOfRadiance) {
  const PlanckFunction planck = PlanckFunction::over({8, 12});
  write_map(folder_ / "map.nc", {25, 75}, "m", "surface_temperature", {280, 300});
  const auto problem_of = [&](const std::string& more) {
    return assembled("irradiance_w_m2 = 0\n" + air +
                     "[thermal]\nband_um = [8, 12]\n[surface]\ntemperature_map = \"map.nc\"\n" + more)
        .problem;
  };
  const std::vector<float> map = problem_of("").surface.planck_map;
  ASSERT_EQ(map.size(), 12U);
  EXPECT_FLOAT_EQ(map[0], static_cast<float>(planck(280)));
  EXPECT_FLOAT_EQ(map[3], static_cast<float>(planck(300)));
  const std::vector<float> mixed =
      problem_of("[domain]\nmin_m = [25, 0, 0]\nmax_m = [100, 75, 50]\n").surface.planck_map;
  EXPECT_EQ(mixed.size(), 9U);
}

TEST_F(AssembleTest, LayersThatAbsorbHaveLevelsFineEnoughForPlanck) {
  const auto levels = [&](const std::string& more) {
    const std::string layer =
        "[[layer]]\nbottom_m = 50\ntop_m = 10050\noptical_depth = 1e-9\nphase_function = "
        "\"isotropic\"\nsingle_scattering_albedo = ";
    return assembled("irradiance_w_m2 = 1\n[atmosphere]\nstandard = \"us-1976\"\n" + layer + more).problem.grid;
  };
  const std::string thermal = "[thermal]\nwavelength_um = 10.8\n[surface]\ntemperature_k = 300\n";
  EXPECT_EQ(levels("0\n").box.nz(), 3);
  EXPECT_EQ(levels("1\n" + thermal).box.nz(), 3) << "matter that does not absorb does not emit";
  const OpticalGrid fine = levels("0\n" + thermal);
  const PlanckFunction planck = PlanckFunction::at(10.8);
  const Atmosphere standard = us_standard_1976();
  EXPECT_GT(fine.box.nz(), 3);
  for (int k = 0; k < fine.box.nz(); ++k) {
    const double low = fine.box.z_edge_m[k], high = fine.box.z_edge_m[k + 1];
    const auto radiance = [&](double z) { return planck(standard.temperature_at(z)); };
    for (const double t : {.25, .5, .75}) {
      EXPECT_NEAR(radiance(low + t * (high - low)), (1 - t) * radiance(low) + t * radiance(high), 1.01e-3 * planck(300))
          << low << " m";
    }
  }
}

}  // namespace
}  // namespace cloudbow
