// LES files in the layouts of models, and files that must not be mistaken for them. Truth: a cloud in an isentropic
// atmosphere, whose pressure, temperature and density are closed forms in balance with their heights.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "les_test_tools.hpp"

namespace cloudbow {
namespace {

using namespace les_test;
using testing::HasSubstr;
using testing::Not;

TEST_F(LesImport, OtherSpeciesAreToldAndNeverMixed) {
  const auto add_rho = [](NetcdfBuilder& file) { file.variable("rho", {"z"}, "kg/m3", profile(density)); };
  const ImportedCloud cloud = import_cloud(with([&](NetcdfBuilder& file) {
    add_rho(file);
    add_water(file, "qi", "kg/kg", 0.3);
    add_water(file, "qr", "kg/kg", 0.5);
    add_water(file, "qg", "kg/kg", 0);
  }));
  expect_truth(cloud);
  EXPECT_THAT(notes_of(cloud), HasSubstr("NOT imported: 'qi', cloud ice"));
  EXPECT_THAT(notes_of(cloud), HasSubstr("NOT imported: 'qr', rain"));
  EXPECT_THAT(notes_of(cloud), Not(HasSubstr("'qg'")));  // nothing there
  EXPECT_THAT(notes_of(cloud), Not(HasSubstr("counts as liquid water")));
  CloudImportOptions ice = with([&](NetcdfBuilder& file) {
    add_rho(file);
    add_water(file, "qi", "kg/kg", 0.3);
  });
  ice.variable = "qi";
  EXPECT_THAT(notes_of(import_cloud(ice)), HasSubstr("'qi' is cloud ice by its name, and counts as liquid water"));

  const auto two = with([&](NetcdfBuilder& file) {
    add_rho(file);
    add_water(file, "ql", "kg/kg", 1.5);
  });
  EXPECT_THAT(error_of(two), HasSubstr("two kinds of liquid water (found 'qc' and 'ql', which differ"));
  CloudImportOptions chosen = two;
  chosen.variable = "ql";
  expect_truth(import_cloud(chosen), 1.5);
  expect_truth(import_cloud(with([&](NetcdfBuilder& file) {  // the same twice
    add_rho(file);
    add_water(file, "ql");
  })));
}

TEST_F(LesImport, WaterAndIceTogetherAreWaterLessIce) {
  const auto sam = [&](bool has_ice, double coldest) {
    return with(
        [&](NetcdfBuilder& file) {
          file.variable("RHO", {"z"}, "kg/m3", profile(density));
          add_water(file, "QN", "g/kg", 1000);
          if (has_ice) add_water(file, "QI", "g/kg", 900);
          file.variable("TABS", {"z"}, "K", profile([coldest](int) { return coldest; }));
        },
        false);
  };
  expect_truth(import_cloud(sam(true, 260)), 0.1, 1e-4);  // a difference of numbers ten times as large
  const ImportedCloud warm = import_cloud(sam(false, 280));
  expect_truth(warm);
  EXPECT_THAT(notes_of(warm), HasSubstr("'QN' is water and ice together, all of it counts as liquid"));
  EXPECT_THAT(error_of(sam(false, 260)), HasSubstr("may hold ice (found 260 K"));
}

TEST_F(LesImport, ExtinctionIsReadInItsUnit) {
  const auto extinction = [&](const std::string& units, double factor) {
    return with(
        [&](NetcdfBuilder& file) {
          add_water(file, "extinction", units, factor);
          file.variable("ssa", {"z"}, "1", profile([](int k) { return 0.9 + 0.01 * k; }));
          file.variable("reff", {"z"}, "Micron", profile([](int) { return 10; }));
        },
        false);
  };
  for (const auto& [units, factor] : {std::pair{"m-1", 1.0}, {"1/km", 1e3}, {"km^-1", 1e3}}) {
    const ImportedCloud cloud = import_cloud(extinction(units, factor));
    EXPECT_EQ(cloud.field.quantity, "extinction");
    ASSERT_EQ(cloud.auxiliaries.size(), 2U);
    EXPECT_NEAR(cloud.field.value[0] / water(3, 0, 0), 1, 1e-6);
    EXPECT_NEAR(cloud.auxiliaries[0].value[0], 10, 1e-6);
    EXPECT_NEAR(cloud.auxiliaries[1].value[0], 0.93, 1e-6);
  }
  EXPECT_THAT(error_of(extinction("", 1)), HasSubstr("unit of extinction not known"));
  EXPECT_THAT(error_of(extinction("m-1", 1e6)), HasSubstr("(allowed up to 10 1/m)"));
  CloudImportOptions options = with([&](NetcdfBuilder& file) {
    file.variable("rho", {"z"}, "kg/m3", profile(density));
    add_water(file, "ext", "1/m", 2);
  });
  const ImportedCloud both = import_cloud(options);
  expect_truth(both);
  EXPECT_THAT(notes_of(both), HasSubstr("NOT imported: 'ext', extinction"));
  options.quantity = "extinction";
  EXPECT_NEAR(import_cloud(options).field.value[0] / water(3, 0, 0), 2, 1e-6);
}

TEST_F(LesImport, NumbersThatNoCloudHasAreRefused) {
  const auto add_rho = [](NetcdfBuilder& file) { file.variable("rho", {"z"}, "kg/m3", profile(density)); };
  CloudImportOptions options = with(add_rho);
  options.units = "g/m3";
  options.variable = "qc";
  EXPECT_GT(import_cloud(options).field.active_voxels(), 0U);
  options.units = "1e5 g/m3";
  EXPECT_THAT(error_of(options), HasSubstr("'qc' [1e5 g/m3]: cell (0, 0, 3) holds"));
  EXPECT_THAT(error_of(options), HasSubstr("(allowed up to 20 g/m3)"));

  options = with(add_rho);
  options.voxel_size_m = {100, 100, 6000};
  options.levels_by_voxel_size = true;
  EXPECT_THAT(error_of(options), HasSubstr("level 0 is 6000 m thick, from 0 to 6000 m (allowed 0.001 to 5000 m)"));

  const auto with_variable = [&](const std::string& name, const std::string& units, double value) {
    return with([&](NetcdfBuilder& file) {
      add_rho(file);
      file.variable(name, {"z"}, units, profile([value](int) { return value; }));
    });
  };
  EXPECT_THAT(error_of(with_variable("reff", "um", 1e-5)), HasSubstr("(allowed 0.1 to 5000 um)"));
  EXPECT_THAT(error_of(with_variable("NC", "cm-3", 1e8)), HasSubstr("droplet number 'NC'"));
  EXPECT_THAT(error_of(with_variable("NC", "m-3", 100)), HasSubstr("(allowed 0.1 to 100000 per cm3)"));

  NetcdfBuilder file(folder_ / "below.nc");
  file.dimension("z", nz);
  file.variable("z", {"z"}, "m", profile([](int k) { return height(k) - 800; }));
  file.variable("lwc", {"z"}, "g/m3", profile([](int k) { return k == 3 ? 0.1 : 0.0; }));
  options = {};
  options.file = file.close();
  options.voxel_size_m = {100, 100, 100};
  EXPECT_THAT(error_of(options), HasSubstr("cloud below the ground (found it at -260 m"));
}

}  // namespace
}  // namespace cloudbow
