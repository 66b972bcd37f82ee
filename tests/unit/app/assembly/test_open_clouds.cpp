// Constituents of clouds, from the scene to the problem. Truth: coefficients counted by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "cloudbow/app/assemble.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/io/droplet_table_file.hpp"
#include "cloudbow/optics/planck.hpp"
#include "temporary_folder.hpp"
#include "usual_memory.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::FloatEq;
using testing::HasSubstr;

/// Liquid of .5 and .25 g/m3 in the columns 0 and 1, ice of .125 g/m3 in the columns 1 and 2, from 0 to 100 m. The
/// columns are 50 m wide. The box of the ice begins with its first voxel.
class Constituents : public testing::Test {
 protected:
  Constituents() {
    write("liquid.vdb", {2, 1, 1}, {0, 0, 0}, {.5F, .25F}, "liquid_water_content", {280, 270});
    write("ice.vdb", {2, 1, 1}, {50, 0, 0}, {.125F, .125F}, "ice_water_content", {270.25F, 260});
  }

  void write(const std::string& file, std::array<int, 3> cells, std::array<double, 3> min_m,
             const std::vector<float>& value, const std::string& quantity, const std::vector<float>& kelvin,
             double size_m = 50) {
    write_cloud_vdb(folder_ / file, make_cloud_field(cells, {size_m, 50, 100}, min_m, value, quantity), {},
                    {{"T", "temperature", "K", kelvin}});
  }

  static std::string cloud(const std::string& name, const std::string& keys) {
    return "[[cloud]]\nname = \"" + name + "\"\nfile = \"" + name + ".vdb\"\n" + keys;
  }
  const std::string liquid_ =
      cloud("liquid", "effective_radius_um = 10\nsingle_scattering_albedo = 0.75\nphase_function = \"isotropic\"\n");
  const std::string ice_ =
      cloud("ice", "effective_radius_um = 30\nsingle_scattering_albedo = 0.5\nphase_function = \"rayleigh\"\n");
  const std::string sun_ = "[sun]\nzenith_deg = 30\nazimuth_deg = 20\n";

  AssembledScene assembled(const std::string& text) {
    return assemble(read_scene(folder_.write("scene.toml", text + sun_)), memory);
  }
  std::string message(const std::string& text) { return message_of(text + sun_); }
  std::string message_of(const std::string& text) {
    try {
      assemble(read_scene(folder_.write("scene.toml", text)), memory);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  TemporaryFolder folder_;
};

// Extinction of liquid 3 LWC / (2 rho r), of ice with the density .917 g/cm3.
TEST_F(Constituents, AddUpInAVoxel) {
  const AssembledScene scene = assembled(liquid_ + ice_ + "[output]\nfields = [\"optical_depth\", \"extinction\"]\n");
  const OpticalGrid& grid = scene.problem.grid;
  EXPECT_EQ(grid.box.nx, 3);
  ASSERT_EQ(grid.active_cells(), 3U);
  ASSERT_EQ(scene.problem.phase.size(), 2U);
  const float liquid = .15F * .5F, ice = .05F / .917F * .125F;  // 1/m, in the first and the last column
  EXPECT_THAT(grid.scattering[0], ElementsAre(FloatEq(.75F * liquid), FloatEq(.375F * liquid), 0));
  EXPECT_THAT(grid.scattering[1], ElementsAre(0, FloatEq(.5F * ice), FloatEq(.5F * ice)));
  EXPECT_THAT(grid.absorption,
              ElementsAre(FloatEq(.25F * liquid), FloatEq(.125F * liquid + .5F * ice), FloatEq(.5F * ice)));
  EXPECT_THAT(scene.cloud_optical_depth,
              ElementsAre(FloatEq(100 * liquid), FloatEq(50 * liquid + 100 * ice), FloatEq(100 * ice)));
  EXPECT_THAT(scene.cloud_extinction, ElementsAre(FloatEq(liquid), FloatEq(.5F * liquid + ice), FloatEq(ice)));
  ASSERT_EQ(scene.clouds.size(), 2U);
  EXPECT_EQ(scene.clouds[0].name, "liquid");
  EXPECT_NEAR(scene.clouds[0].water_path_g_m2->sum, 75, 1e-4);
  EXPECT_NEAR(scene.clouds[1].water_path_g_m2->largest, 12.5, 1e-4);
  EXPECT_NEAR(scene.clouds[1].optical_depth.sum, 200 * ice, 1e-6);
  EXPECT_EQ(*scene.clouds[1].effective_radius_um, (std::array<double, 2>{30, 30}));
}

TEST_F(Constituents, OrderDoesNotMatter) {
  const OpticalGrid one = assembled(liquid_ + ice_).problem.grid, other = assembled(ice_ + liquid_).problem.grid;
  EXPECT_EQ(one.absorption, other.absorption);
  EXPECT_EQ(one.scattering[0], other.scattering[1]);
  EXPECT_EQ(one.scattering[1], other.scattering[0]);
}

// A constituent alone is what [cloud] is.
TEST_F(Constituents, OneIsACloud) {
  std::string table = liquid_;
  table.replace(0, std::string("[[cloud]]").size(), "[cloud]");
  const OpticalGrid one = assembled(liquid_).problem.grid, cloud = assembled(table).problem.grid;
  EXPECT_EQ(one.absorption, cloud.absorption);
  EXPECT_EQ(one.scattering, cloud.scattering);
  table.erase(table.find("name"), std::string("name = \"liquid\"\n").size());
  const AssembledScene nameless = assembled(table);
  EXPECT_EQ(nameless.problem.grid.absorption, cloud.absorption);
  EXPECT_EQ(nameless.clouds.at(0).name, "");
}

// Droplets by voxel of both: each constituent has its own classes, one after the other.
TEST_F(Constituents, ClassesByConstituent) {
  write_droplet_table(folder_ / "drops.h5",
                      {0.67, {5, 10}, {0.4, 0.1}, {0.5, 1}, {{1, 0.4, 0.1, 0.008}, {1, 0.2, 0.05, 0.002}}},
                      {{1.33, 0}, "", 1, "gamma", 0.1, "", ""});
  write_droplet_table(folder_ / "crystals.h5",
                      {0.67, {20, 40}, {0.2, 0.1}, {1, 1}, {{1, 0.3, 0.05, 0.002}, {1, 0.35, 0.06, 0.002}}},
                      {{1.31, 0}, "", 1, "gamma", 0.1, "", ""});
  const auto with_radii = [&](const std::string& file, double x_m, const std::vector<float>& content,
                              const std::string& quantity, const std::vector<float>& radii) {
    write_cloud_vdb(folder_ / file, make_cloud_field({2, 1, 1}, {50, 50, 100}, {x_m, 0, 0}, content, quantity), {},
                    {{"reff", "effective_radius", "um", radii}});
  };
  with_radii("liquid.vdb", 0, {.5F, .25F}, "liquid_water_content", {5, 10});
  with_radii("ice.vdb", 50, {.125F, .125F}, "ice_water_content", {40, 20});
  const std::string optics = "effective_radius_grid = \"reff\"\nphase_function = ";
  const std::string tables =
      "[phase_function.drops]\ntype = \"mie\"\nfile = \"drops.h5\"\n"
      "[phase_function.crystals]\ntype = \"mie\"\nfile = \"crystals.h5\"\n[solver]\nclass_tolerance = 0\n";
  const AssembledScene scene =
      assembled(cloud("liquid", optics + "\"drops\"\n") + cloud("ice", optics + "\"crystals\"\n") + tables);
  ASSERT_EQ(scene.problem.phase.size(), 4U);
  EXPECT_NEAR(scene.problem.phase[1].asymmetry_parameter(), .2, 1e-9);
  EXPECT_NEAR(scene.problem.phase[3].asymmetry_parameter(), .35, 1e-9);
  const OpticalGrid& grid = scene.problem.grid;
  EXPECT_THAT(grid.scattering[0], ElementsAre(FloatEq(.5F * .4F * .5F), 0, 0));
  EXPECT_THAT(grid.scattering[1], ElementsAre(0, FloatEq(.25F * .1F), 0));
  EXPECT_THAT(grid.scattering[2], ElementsAre(0, 0, FloatEq(.125F * .2F)));
  EXPECT_THAT(grid.scattering[3], ElementsAre(0, FloatEq(.125F * .1F), 0));
  ASSERT_TRUE(scene.phase_classes);
  EXPECT_EQ(scene.phase_classes->functions, 4);
  EXPECT_EQ(scene.phase_classes->classes, 4);
  EXPECT_THAT(scene.clouds[1].effective_radius_um.value(), ElementsAre(20, 40));
}

// The mean over all scattering: half of it belongs to a constituent without classes.
TEST_F(Constituents, ErrorOfClassesIsThatOfAllScattering) {
  write_droplet_table(folder_ / "drops.h5",
                      {0.67,
                       {5, 7, 10},
                       {0.4, 0.2, 0.1},
                       {1, 1, 1},
                       {{1, 0.4, 0.1, 0.008}, {1, 0.2, 0.1, 0.007}, {1, 0.1, 0.05, 0.002}}},
                      {{1.33, 0}, "", 1, "gamma", 0.1, "", ""});
  const CloudField field = make_cloud_field({3, 1, 1}, {50, 50, 100}, {0, 0, 0}, {1, 2, 4}, "liquid_water_content");
  write_cloud_vdb(folder_ / "liquid.vdb", field, {}, {{"reff", "effective_radius", "um", {5, 7, 10}}});
  const std::string liquid = cloud("liquid", "effective_radius_grid = \"reff\"\nphase_function = \"drops\"\n");
  const std::string table =
      "[phase_function.drops]\ntype = \"mie\"\nfile = \"drops.h5\"\n[solver]\nclass_tolerance = 0.1\n";
  const AssembledScene alone = assembled(liquid + table);
  ASSERT_GT(alone.phase_classes->estimated_error, 0);
  // 1.2 per metre are scattered by the liquid in all, as much by the ice.
  write("ice.vdb", {2, 1, 1}, {50, 0, 0}, {.6F, .6F}, "extinction", {270, 270});
  const std::string ice = cloud("ice", "single_scattering_albedo = 1\nphase_function = \"rayleigh\"\n");
  const AssembledScene both = assembled(liquid + ice + table);
  EXPECT_EQ(both.phase_classes->classes, alone.phase_classes->classes);
  EXPECT_NEAR(both.phase_classes->estimated_error / alone.phase_classes->estimated_error, .5, 1e-6);
}

// Voxel by voxel: 280 K, then both constituents within the rounding of half precision, then ice alone.
TEST_F(Constituents, HaveOneTemperatureInAVoxel) {
  const std::string emission =
      "[atmosphere]\nheight_m = [0, 1000]\ntemperature_k = [290, 280]\nstandard = \"us-1976\"\n"
      "[thermal]\nwavelength_um = 10.8\n[surface]\ntemperature_k = 300\n";
  const auto planck_of = [&](const std::string& clouds) {
    return assemble(read_scene(folder_.write("scene.toml", clouds + emission)), memory).problem.grid.planck;
  };
  const PlanckFunction planck = PlanckFunction::at(10.8);
  const std::string own = "temperature_grid = \"T\"\n";
  constexpr double chord = 1e-3;  // B over the slope of the air, 1 K in the voxel
  const std::vector<float> both = planck_of(liquid_ + own + ice_ + own);
  ASSERT_EQ(both.size(), 3U);
  EXPECT_NEAR(both[0] / planck(280), 1, chord);
  EXPECT_NEAR(both[1] / planck(270), 1, chord) << "that of the first that has one";
  EXPECT_NEAR(both[2] / planck(260), 1, chord);
  const std::vector<float> of_liquid = planck_of(liquid_ + own + ice_);
  EXPECT_NEAR(of_liquid[1] / planck(270), 1, chord);
  EXPECT_NEAR(of_liquid[2] / planck(289.5), 1, chord) << "ice alone: that of the air";
  write("ice.vdb", {2, 1, 1}, {50, 0, 0}, {.125F, .125F}, "ice_water_content", {265, 260});
  EXPECT_THAT(message_of(liquid_ + own + ice_ + own + emission),
              AllOf(HasSubstr("scene.toml:14: cloud.1.temperature_grid: another temperature"), HasSubstr("265 K"),
                    HasSubstr("270 K")));
}

// Grids of one file, added up in a voxel.
TEST_F(Constituents, GridsOfOneAddUp) {
  const CloudField cloud = make_cloud_field({2, 1, 1}, {50, 50, 100}, {0, 0, 0}, {.5F, .25F}, "liquid_water_content");
  write_cloud_vdb(
      folder_ / "liquid.vdb", cloud, {},
      {{"rain", "liquid_water_content", "g/m3", {.125F, 0}}, {"snow", "ice_water_content", "g/m3", {1, 1}}});
  const auto with_grids = [&](const std::string& grids) { return liquid_ + "grid = " + grids + "\n"; };
  EXPECT_THAT(assembled(with_grids("[\"density\", \"rain\"]")).problem.grid.scattering[0],
              ElementsAre(FloatEq(.75F * .15F * .625F), FloatEq(.75F * .15F * .25F)));
  EXPECT_EQ(assembled(with_grids("[\"density\"]")).problem.grid.scattering,
            assembled(with_grids("\"density\"")).problem.grid.scattering);
  EXPECT_THAT(message(with_grids("[\"density\", \"snow\"]")),
              AllOf(HasSubstr("grid \"snow\": cannot be added to the grid \"density\""),
                    HasSubstr("found ice_water_content in g/m3, allowed liquid_water_content in g/m3")));
  EXPECT_THAT(message(with_grids("[\"density\", \"hail\"]")), HasSubstr("hail"));
}

// By the names of an import: rain is water, snow is ice.
TEST_F(Constituents, QuantitiesOfOneFile) {
  for (const auto& [quantity, density] : {std::pair{"rain_water_content", 1.}, std::pair{"snow_water_content", .917}}) {
    write("ice.vdb", {1, 1, 1}, {0, 0, 0}, {.5F}, quantity, {260});
    const AssembledScene scene = assembled(ice_);
    EXPECT_NEAR(scene.clouds.at(0).optical_depth.sum, 100 * .05 * .5 / density, 1e-6) << quantity;
    EXPECT_NEAR(scene.clouds[0].water_path_g_m2->sum, 50, 1e-4);
  }
  // A radius by voxel gives the same.
  const CloudField field = make_cloud_field({1, 1, 1}, {50, 50, 100}, {0, 0, 0}, {.5F}, "snow_water_content");
  write_cloud_vdb(folder_ / "ice.vdb", field, {}, {{"reff", "effective_radius", "um", {30}}});
  std::string by_voxel = ice_;
  by_voxel.replace(by_voxel.find("effective_radius_um = 30"), 24, "effective_radius_grid = \"reff\"");
  EXPECT_NEAR(assembled(by_voxel).clouds.at(0).optical_depth.sum, 100 * .05 * .5 / .917, 1e-6);
}

TEST_F(Constituents, OtherVoxelsAreErrors) {
  write("ice.vdb", {2, 1, 1}, {25, 0, 0}, {.125F, .125F}, "ice_water_content", {270, 260});
  EXPECT_THAT(message(liquid_ + ice_),
              AllOf(HasSubstr("scene.toml:9: cloud.1.file: \"ice\" has other voxels than"), HasSubstr("\"liquid\""),
                    HasSubstr("along x"), HasSubstr("at 25 m"), HasSubstr("resample")));
  write("ice.vdb", {2, 1, 1}, {50, 0, 0}, {.125F, .125F}, "ice_water_content", {270, 260}, 25);
  EXPECT_THAT(message(liquid_ + ice_), AllOf(HasSubstr("along x voxels of 25 m"), HasSubstr("of the other 50 m")));
}

TEST_F(Constituents, MessagesNameTheConstituent) {
  std::string without_radius = ice_;
  without_radius.erase(without_radius.find("effective"), std::string("effective_radius_um = 30\n").size());
  EXPECT_THAT(message(liquid_ + without_radius),
              AllOf(HasSubstr("cloud.1.effective_radius_um: missing"), HasSubstr("ice_water_content")));
  EXPECT_THAT(message(liquid_ + ice_ + "quantity = \"liquid_water_content\"\n"),
              HasSubstr("scene.toml:13: cloud.1.quantity: contradicts"));
}

}  // namespace
}  // namespace cloudbow
