// Layouts of models, levels that follow the terrain, air from other files, several species, series. Truth: sums by hand
// over the numbers that the files are made of, and closed forms of the isentropic atmosphere.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "les_test_tools.hpp"

namespace cloudbow {
namespace {

using namespace les_test;
using testing::HasSubstr;
using testing::Not;

// -- layouts ----------------------------------------------------------------------------------------------------------

TEST_F(LesImport, ModelsAreRecognisedAndTheNoteSaysBy) {
  const auto note = [&](const std::function<void(NetcdfBuilder&)>& add, bool has_water = false) {
    CloudImportOptions options = with(
        [&](NetcdfBuilder& file) {
          file.variable("rho", {"z"}, "kg/m3", profile(density));
          add(file);
        },
        has_water);
    return notes_of(import_cloud(options));
  };
  const auto named = [&](const std::string& liquid, const std::vector<std::string>& others) {
    return note([&](NetcdfBuilder& file) {
      add_water(file, liquid);
      for (const std::string& other : others) file.variable(other, {"z"}, "", profile([](int) { return 1.1; }));
    });
  };
  EXPECT_THAT(named("RCP", {}), HasSubstr("model: RAMS (by the names 'RCP')"));
  EXPECT_THAT(named("clwc", {}), HasSubstr("model: ERA5 (by the names 'clwc')"));
  EXPECT_THAT(named("RCT", {"THT"}), HasSubstr("model: Meso-NH (by the names 'RCT', 'THT')"));
  EXPECT_THAT(named("q_cloud_liquid_mass", {}), HasSubstr("model: MONC (by"));
  EXPECT_THAT(named("qc", {"prs", "th"}), HasSubstr("model: CM1 (by the names 'prs', 'th')"));
  EXPECT_THAT(named("l", {"dn0"}), HasSubstr("model: UCLALES (by the names 'l', 'dn0')"));
  EXPECT_THAT(named("ql", {"thl", "rhobf"}), HasSubstr("model: DALES (by the names 'ql', 'rhobf')"));
  EXPECT_THAT(named("ql", {"phydro"}), HasSubstr("model: MicroHH (by the names 'phydro', 'ql')"));
  EXPECT_THAT(named("QC", {"TABS"}), HasSubstr("model: SAM (by the names 'QC', 'TABS')"));
  const std::string by_title = note([](NetcdfBuilder& file) { file.text("", "title", "PALM 23.10"); }, true);
  EXPECT_THAT(by_title, HasSubstr("model: PALM (the file's attribute title says so)"));
  EXPECT_THAT(note([](NetcdfBuilder& file) { file.text("", "source", "a sample of napalm"); }, true),
              Not(HasSubstr("model:")));
  EXPECT_THAT(note([](NetcdfBuilder&) {}, true), Not(HasSubstr("model:")));
}

TEST_F(LesImport, TheModelMayBeSaid) {
  CloudImportOptions options = with([](NetcdfBuilder& file) {
    file.variable("rho", {"z"}, "kg/m3", profile(density));
    file.variable("p", {"z"}, "Pa", profile([](int) { return 0.3; }));
  });
  options.model = "cm1";
  EXPECT_THAT(notes_of(import_cloud(options)), HasSubstr("model: CM1 (as --model says)"));
  options.model = "rams";
  EXPECT_THAT(error_of(options), AllOf(HasSubstr("no water of the model that --model names, RAMS (found none of RCP"),
                                       HasSubstr("--variable")));
  options.variable = "qc";
  expect_truth(import_cloud(options));
  options.model = "mm5";
  EXPECT_THAT(error_of(options), HasSubstr("--model: unknown (found \"mm5\", allowed auto, cm1"));
}

TEST_F(LesImport, FilesOfOtherKindsSayWhatToDo) {
  CloudImportOptions options = with([](NetcdfBuilder& file) { add_water(file, "qi"); }, false);
  EXPECT_THAT(error_of(options), HasSubstr("or give --species ice for its cloud ice"));
  options.file = folder_ / "a.grib";
  std::ofstream(options.file) << "GRIB and more";
  EXPECT_THAT(error_of(options), HasSubstr("convert it first"));
}

// -- species ----------------------------------------------------------------------------------------------------------

class SpeciesImport : public LesImport {
 protected:
  static double ice(int k, int j, int i) { return k < 5 || k > 8 ? 0 : 2e-5 * (k + j + 1 + 2 * i); }
  CloudImportOptions cold(const std::vector<std::string>& species, bool has_water = true) const {
    CloudImportOptions options = with(
        [](NetcdfBuilder& file) {
          file.variable("rho", {"z"}, "kg/m3", profile(density));
          file.variable("T", {"z"}, "K", profile(kelvin));
          file.variable("qi", {"z", "y", "x"}, "g/kg", field([](int k, int j, int i) { return 1e3 * ice(k, j, i); }));
          file.variable("re_ice", {"z"}, "um", profile([](int k) { return 20 + k; }));
          file.variable("qr", {"z", "y", "x"}, "kg/kg", field([](int, int, int) { return 0; }));
        },
        has_water);
    options.species = species;
    return options;
  }
};

TEST_F(SpeciesImport, EachHasAGridOnItsOwnVoxels) {
  for (const std::vector<std::string>& species : {std::vector<std::string>{"liquid", "ice"}, {"all"}}) {
    CloudImportOptions options = cold(species);
    options.temperature_grid = true;
    const ImportedCloud cloud = import_cloud(options);
    expect_truth(cloud);
    EXPECT_EQ(cloud.grid, "density");
    ASSERT_EQ(cloud.others.size(), 2U);
    const VdbCloudGrid &frozen = cloud.others[0], &warmth = cloud.others[1];
    EXPECT_EQ(frozen.grid, "ice_water_content");
    EXPECT_EQ(frozen.field.quantity, "ice_water_content");
    EXPECT_EQ(frozen.field.cells, cloud.field.cells);
    ASSERT_EQ(frozen.auxiliaries.size(), 1U);
    EXPECT_EQ(frozen.auxiliaries[0].grid, "reff_ice");
    const std::vector<float> dense = to_dense(frozen.field), hot = to_dense(warmth.field), wet = to_dense(cloud.field);
    std::size_t n = 0, active = 0;
    for (int k = 0; k < nz; ++k) {
      for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i, ++n) {
          EXPECT_NEAR(dense[n], 1e3 * ice(k, j, i) * density(k), 1e-6 * 1e3 * ice(k, j, i));
          if (dense[n] > 0) {
            EXPECT_NEAR(frozen.auxiliaries[0].value[active++], 20 + k, 1e-4);
          }
          EXPECT_NEAR(hot[n], dense[n] > 0 || wet[n] > 0 ? kelvin(k) : 0, 1e-3);
        }
      }
    }
    if (species.size() == 1) {
      EXPECT_THAT(notes_of(cloud), HasSubstr("rain_water_content: none at this time, no grid"));
    }
    EXPECT_THAT(notes_of(cloud), Not(HasSubstr("NOT imported")));
  }
}

TEST_F(SpeciesImport, IceAloneIsTheCloud) {
  const ImportedCloud cloud = import_cloud(cold({"ice"}, false));
  EXPECT_EQ(cloud.grid, "ice_water_content");
  EXPECT_EQ(cloud.field.quantity, "ice_water_content");
  EXPECT_NEAR(cloud.field.value[0] / (1e3 * ice(5, 0, 0) * density(5)), 1, 1e-6);
  ASSERT_EQ(cloud.auxiliaries.size(), 1U);
  EXPECT_EQ(cloud.auxiliaries[0].grid, "reff_ice");
  EXPECT_EQ(import_cloud(cold({"all"}, false)).grid, "ice_water_content");
}

TEST_F(SpeciesImport, WhatTheFileLacksIsNamed) {
  EXPECT_THAT(error_of(cold({"liquid", "snow"})),
              AllOf(HasSubstr("no variable of snow (looked for QS, qs"), HasSubstr("leave snow out of --species")));
  CloudImportOptions contradictory = cold({"ice"});
  contradictory.variable = "qc";
  EXPECT_THAT(error_of(contradictory), HasSubstr("--species: without liquid (found --variable"));
  contradictory = cold({"liquid"});
  contradictory.quantity = "extinction";
  EXPECT_THAT(error_of(contradictory), HasSubstr("--species: of water alone (found --quantity extinction)"));
  EXPECT_THAT(notes_of(import_cloud(cold({}))), HasSubstr("NOT imported: 'qi', cloud ice"));
  EXPECT_THAT(notes_of(import_cloud(cold({}))), HasSubstr("--species liquid,ice imports it"));
}

TEST_F(SpeciesImport, MoreThanOneFitOnAVdbFile) {
  CloudImportOptions options = cold({"liquid", "ice"});
  options.temperature_grid = true;
  const ImportedCloud cloud = import_cloud(options);
  VdbWriteOptions write;
  write.grid = cloud.grid;
  const auto path = folder_ / "species.vdb";
  write_cloud_vdb(path, cloud.field, write, cloud.auxiliaries, cloud.others);
  const CloudInfo info = describe_cloud_vdb(path);
  ASSERT_EQ(info.grids.size(), 4U);
  VdbReadOptions read;
  read.grid = "ice_water_content";
  const VdbCloud frozen = read_cloud_vdb(path, read);
  EXPECT_EQ(frozen.quantity, "ice_water_content");
  EXPECT_EQ(frozen.units, "g/m3");
  EXPECT_EQ(frozen.value, cloud.others[0].field.value);
  read.grid = "temperature";
  EXPECT_EQ(read_auxiliary_vdb(path, frozen, read).size(), frozen.value.size());
  read.grid = "reff_ice";
  EXPECT_EQ(read_auxiliary_vdb(path, frozen, read), cloud.others[0].auxiliaries[0].value);
}

// -- series -----------------------------------------------------------------------------------------------------------

TEST_F(LesImport, MomentsOfASeriesMayBeClear) {
  NetcdfBuilder file(folder_ / "series.nc");
  file.dimension("time", 3);
  add_axes(file);
  std::vector<double> values;
  for (int t = 0; t < 3; ++t) {
    const std::vector<double> moment = field([t](int k, int j, int i) { return t * water(k, j, i); });
    values.insert(values.end(), moment.begin(), moment.end());
  }
  file.variable("qc", {"time", "z", "y", "x"}, "kg/kg", values);
  file.variable("rho", {"z"}, "kg/m3", profile(density));
  CloudImportOptions options;
  options.file = file.close();
  EXPECT_EQ(count_times(options), 3U);
  EXPECT_THAT(error_of(options), HasSubstr("no cloud"));
  options.may_be_clear = true;
  EXPECT_TRUE(import_cloud(options).field.value.empty());
  options.time = 2;
  expect_truth(import_cloud(options), 2);
  EXPECT_EQ(count_times(with([](NetcdfBuilder& f) { f.variable("rho", {"z"}, "kg/m3", profile(density)); })), 1U);
}

}  // namespace
}  // namespace cloudbow
