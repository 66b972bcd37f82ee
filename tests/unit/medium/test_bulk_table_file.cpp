// Tables of bulk optics from files. Truth: the numbers in the files that the tests write, and ecRad's own files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "../near_with_report.hpp"
#include "cloud_test_tools.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/bulk_table_file.hpp"
#include "cloudbow/optics/mie_bulk.hpp"
#include "netcdf_builder.hpp"

namespace cloudbow {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;
using testing::ThrowsMessage;

/// Numbers of 32 bits in files.
constexpr double single = 1e-6;

struct Layout {
  std::string wavenumber_units = "cm-1";
  std::string radius_units = "m";
  std::string extinction_units = "m2 kg-1";
  std::vector<double> wavenumber{1000, 2000, 3000};
  std::vector<double> radius{5e-6, 1e-5};
  std::vector<double> extinction{300, 200, 100, 150, 100, 50};  // [radius][wavenumber]
  std::vector<double> albedo{1, .9, .8, .7, .6, .5};
  std::vector<std::string> dimensions{"effective_radius", "wavenumber"};
};

fs::path scratch_file() { return fs::temp_directory_path() / ("cloudbow_bulk_" + std::to_string(getpid()) + ".nc"); }

fs::path write(const Layout& layout) {
  NetcdfBuilder file(scratch_file());
  file.dimension("effective_radius", layout.radius.size());
  file.dimension("wavenumber", layout.wavenumber.size());
  file.variable("wavenumber", {"wavenumber"}, layout.wavenumber_units, layout.wavenumber);
  file.variable("effective_radius", {"effective_radius"}, layout.radius_units, layout.radius);
  file.variable("mass_extinction_coefficient", layout.dimensions, layout.extinction_units, layout.extinction);
  file.variable("single_scattering_albedo", layout.dimensions, "", layout.albedo);
  file.variable("asymmetry_factor", layout.dimensions, "1", std::vector<double>(layout.albedo.size(), .85));
  return file.close();
}

class BulkTableFile : public testing::Test {
 protected:
  void TearDown() override { fs::remove(scratch_file()); }

  static void expect_refused(const Layout& layout, const std::string& text) {
    const fs::path file = write(layout);
    EXPECT_THAT([&] { read_bulk_table(file); },
                ThrowsMessage<InputError>(AllOf(HasSubstr(file.string()), HasSubstr(text))));
  }
};

TEST_F(BulkTableFile, IsReadWithItsUnits) {
  const BulkTable table = read_bulk_table(write({}));
  EXPECT_THAT(table.wavenumber_cm1, ElementsAre(1000, 2000, 3000));
  ASSERT_THAT(table.effective_radius_um, SizeIs(2));
  EXPECT_NEAR(table.effective_radius_um[1], 10, 10 * single);
  EXPECT_NEAR(table.value[2][0].extinction_m2_per_g, .1, single);
  EXPECT_NEAR(table.value[0][1].extinction_m2_per_g, .15, single);
  EXPECT_NEAR(table.value[1][1].single_scattering_albedo, .6, single);
  EXPECT_NEAR(table.value[1][1].asymmetry, .85, single);
  EXPECT_EQ(table.name, scratch_file().string());
}

TEST_F(BulkTableFile, OtherUnitsAndOrderAreTheSame) {
  Layout other;
  other.wavenumber_units = "m-1";
  other.wavenumber = {1e5, 2e5, 3e5};
  other.radius_units = "um";
  other.radius = {5, 10};
  other.extinction_units = "m2 g-1";
  other.dimensions = {"wavenumber", "effective_radius"};
  other.extinction = {.3, .15, .2, .1, .1, .05};
  other.albedo = {1, .7, .9, .6, .8, .5};
  const BulkTable same = read_bulk_table(write(other)), table = read_bulk_table(write({}));
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_NEAR(same.wavenumber_cm1[n], table.wavenumber_cm1[n], 3000 * single);
    for (std::size_t r = 0; r < 2; ++r) {
      EXPECT_NEAR(same.value[n][r].extinction_m2_per_g, table.value[n][r].extinction_m2_per_g, single);
      EXPECT_NEAR(same.value[n][r].single_scattering_albedo, table.value[n][r].single_scattering_albedo, single);
    }
  }
}

TEST_F(BulkTableFile, RefusesUnknownUnitsAndImpossibleValues) {
  Layout layout;
  layout.wavenumber_units = "furlong-1";
  expect_refused(layout, "'wavenumber': unit not known (found \"furlong-1\", allowed cm-1, m-1)");
  layout = {};
  layout.radius_units = "";
  expect_refused(layout, "'effective_radius': unit not known (found \"\", allowed um, m)");
  layout = {};
  layout.extinction_units = "m-1";
  expect_refused(layout, "'mass_extinction_coefficient': unit not known (found \"m-1\", allowed m2 kg-1, m2 g-1)");
  layout = {};
  layout.radius_units = "um";
  layout.radius = {5e-6, 1e-5};
  expect_refused(layout, "effective radius out of range");
  layout = {};
  layout.wavenumber = {3000, 2000, 1000};
  expect_refused(layout, "wavenumber does not ascend");
  layout = {};
  layout.albedo[3] = 1.01;
  expect_refused(layout, "single-scattering albedo out of range (found 1.01");
  layout = {};
  layout.extinction[0] = -1;
  expect_refused(layout, "mass extinction out of range");
}

TEST_F(BulkTableFile, OtherFilesGetOneMessage) {
  {
    NetcdfBuilder file(scratch_file());
    file.dimension("x", 2);
    file.variable("albedo", {"x"}, "1", {.1, .2});
    file.close();
  }
  EXPECT_THAT([] { read_bulk_table(scratch_file()); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("not a table of bulk optics"), HasSubstr("found albedo"),
                                              HasSubstr("mass_extinction_coefficient"))));
  {
    NetcdfBuilder file(scratch_file());
    file.dimension("wavenumber", 2);
    file.dimension("effective_radius", 1);
    file.variable("wavenumber", {"wavenumber"}, "cm-1", {1, 2});
    file.variable("effective_radius", {"effective_radius"}, "m", {1e-5});
    for (const char* name : {"mass_extinction_coefficient", "single_scattering_albedo", "asymmetry_factor"}) {
      file.variable(name, {"wavenumber"}, "m2 kg-1", {1, 2});
    }
    file.close();
  }
  EXPECT_THAT([] { read_bulk_table(scratch_file()); },
              ThrowsMessage<InputError>(HasSubstr("found wavenumber, allowed effective_radius, wavenumber")));
  std::ofstream(scratch_file()) << "0.5 0.1\n";
  EXPECT_THAT([] { read_bulk_table(scratch_file()); }, ThrowsMessage<InputError>(HasSubstr("not netCDF")));
  EXPECT_THAT([] { read_bulk_table("no_such_file.nc"); }, ThrowsMessage<InputError>(HasSubstr("no such file")));
}

/// ecRad's files, outside the project: $CLOUDBOW_REFERENCE_DIR/gas.
fs::path reference(const char* name) {
  const char* folder = std::getenv("CLOUDBOW_REFERENCE_DIR");
  return folder == nullptr ? fs::path() : fs::path(folder) / "gas" / name;
}

TEST_F(BulkTableFile, ReadsEcradsDroplets) {
  const fs::path file = reference("mie_droplet_scattering.nc");
  if (file.empty()) GTEST_SKIP() << "CLOUDBOW_REFERENCE_DIR is not set";
  const BulkTable table = read_bulk_table(file);
  ASSERT_THAT(table.wavenumber_cm1, SizeIs(396));
  ASSERT_THAT(table.effective_radius_um, SizeIs(50));
  // The first and last numbers of the file, as ncdump prints them.
  EXPECT_NEAR(table.wavenumber_cm1.front(), 5, single);
  EXPECT_NEAR(table.wavenumber_cm1.back(), 50000, 50000 * single);
  EXPECT_NEAR(table.value[0][0].extinction_m2_per_g / 1.7536663e-3, 1, single);
  EXPECT_NEAR(table.value[395][49].extinction_m2_per_g / 30.248867e-3, 1, single);
  EXPECT_NEAR(table.value[395][49].single_scattering_albedo, .9996923, single);
  EXPECT_NEAR(table.value[395][49].asymmetry, .86082983, single);
}

TEST_F(BulkTableFile, ReadsEcradsIce) {
  const fs::path file = reference("baum-general-habit-mixture_ice_scattering.nc");
  if (file.empty()) GTEST_SKIP() << "CLOUDBOW_REFERENCE_DIR is not set";
  const BulkTable table = read_bulk_table(file);
  ASSERT_THAT(table.wavenumber_cm1, SizeIs(445));
  ASSERT_THAT(table.effective_radius_um, SizeIs(23));
  EXPECT_NEAR(table.value[0][0].extinction_m2_per_g / 27.088331e-3, 1, single);
  EXPECT_NEAR(table.value[0][0].single_scattering_albedo, .2583, single);
  EXPECT_NEAR(table.value[444][22].asymmetry, .7681, single);
}

// The program's Mie tables against ecRad's, by another program, at 10 um. Its gamma distribution of shape 2 in diameter
// has the effective variance 1/5, as here. The refractive index is of another compilation, which shows in the windows:
// with that of Hale & Querry (1973) the extinction here is .1284 at 10.8 um and .2002 at 8.5 um, as in the file.
TEST_F(BulkTableFile, OwnMieTablesAgreeWithEcrads) {
  const fs::path file = reference("mie_droplet_scattering.nc");
  if (file.empty()) GTEST_SKIP() << "CLOUDBOW_REFERENCE_DIR is not set";
  const BulkTable table = read_bulk_table(file);
  MieBulkRecipe recipe;
  recipe.effective_variance = .2;
  struct Slack {
    double wavelength_um, extinction, albedo, asymmetry;
  };
  // Measured: .1 % in sunlight, 3, 11 and 7 % in the windows.
  for (const Slack& slack : {Slack{.45, .002, 1e-4, .003}, Slack{.55, .002, 1e-4, .003}, Slack{.85, .002, 1e-4, .003},
                             Slack{1.6, .002, 5e-4, .003}, Slack{2.2, .002, 1e-3, .003}, Slack{8.5, .04, .01, .012},
                             Slack{10.8, .12, .05, .007}, Slack{12, .09, .04, .003}, Slack{20, .01, .005, .006}}) {
    const double nu = 1e4 / slack.wavelength_um;
    const auto ecrad = at_radius(table, average_over(table, std::vector{nu - 1, nu + 1}, std::vector{1., 1.}), 10);
    const auto own = make_mie_bulk_table(recipe, std::vector{slack.wavelength_um}, std::vector{10.}).value[0][0];
    EXPECT_NEAR(own.extinction_m2_per_g / ecrad.extinction_m2_per_g, 1, slack.extinction) << slack.wavelength_um;
    EXPECT_NEAR(own.single_scattering_albedo, ecrad.single_scattering_albedo, slack.albedo) << slack.wavelength_um;
    EXPECT_NEAR(own.asymmetry, ecrad.asymmetry, slack.asymmetry) << slack.wavelength_um;
  }
}

}  // namespace
}  // namespace cloudbow
