// Clouds of others. Truths: sums over the levels as they are written here (columns keep their mass); closed forms of
// the effective radius; and the fields of tests' reference folder if it exists.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>

#include "cloud_test_tools.hpp"
#include "cloudbow/medium/cloud_import.hpp"
#include "import_test_tools.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

/// Contents of a small LES file; each test invalidates one of them.
struct LesFile {
  int format = NC_NETCDF4;
  std::string water = "QC";
  std::string units = "g/kg";
  std::vector<double> centre{5, 15, 26, 39.5, 56, 76, 100, 128};  // stretched
  std::string height_units = "m";
  std::size_t times = 2;
  bool with_density = true;
  std::function<double(int k, int j, int i)> value = [](int k, int j, int i) {
    return k < 2 || k > 5 ? 0.0 : 0.1 * k + 0.01 * i + 0.02 * j;
  };

  static constexpr int nx = 3, ny = 2;
  static double density(int k) { return 1.2 - 0.01 * k; }

  std::filesystem::path write(const std::filesystem::path& path) const {
    int id = 0, dims[4], variable = 0;
    const auto check = [](int status) { ASSERT_EQ(status, NC_NOERR) << nc_strerror(status); };
    const auto nz = static_cast<int>(centre.size());
    check(nc_create(path.c_str(), NC_CLOBBER | format, &id));
    check(nc_def_dim(id, "time", NC_UNLIMITED, &dims[0]));
    check(nc_def_dim(id, "z", centre.size(), &dims[1]));
    check(nc_def_dim(id, "y", ny, &dims[2]));
    check(nc_def_dim(id, "x", nx, &dims[3]));
    const auto define = [&](const std::string& name, int rank, const int* shape, const std::string& unit) {
      int made = 0;
      EXPECT_EQ(nc_def_var(id, name.c_str(), NC_FLOAT, rank, shape, &made), NC_NOERR);
      EXPECT_EQ(nc_put_att_text(id, made, "units", unit.size(), unit.c_str()), NC_NOERR);
      return made;
    };
    const int x = define("x", 1, &dims[3], "m"), y = define("y", 1, &dims[2], "m"),
              z = define("z", 1, &dims[1], height_units);
    const int rho = with_density ? define("RHO", 1, &dims[1], "kg/m3") : -1;
    const int number = define("NC", 1, &dims[1], "cm-3");
    variable = define(water, 4, dims, units);
    check(nc_enddef(id));
    const auto put = [&](int which, const std::vector<double>& numbers) {
      const std::size_t start = 0, count = numbers.size();
      EXPECT_EQ(nc_put_vara_double(id, which, &start, &count, numbers.data()), NC_NOERR);
    };
    put(x, {25, 75, 125});
    put(y, {20, 60});
    put(z, centre);
    std::vector<double> air;
    for (int k = 0; k < nz; ++k) air.push_back(density(k));
    if (with_density) put(rho, air);
    put(number, std::vector<double>(centre.size(), 100));
    for (std::size_t t = 0; t < times; ++t) {
      std::vector<double> numbers;
      for (int k = 0; k < nz; ++k) {
        for (int j = 0; j < ny; ++j) {
          for (int i = 0; i < nx; ++i) numbers.push_back((static_cast<double>(t) + 1) * value(k, j, i));
        }
      }
      const std::size_t start[4] = {t, 0, 0, 0}, count[4] = {1, centre.size(), ny, nx};
      check(nc_put_vara_double(id, variable, start, count, numbers.data()));
    }
    nc_close(id);
    return path;
  }

  /// Liquid water path of a column [g/m2] by the levels' own thicknesses.
  double path_of(int j, int i) const {
    double sum = 0;
    for (std::size_t k = 0; k < centre.size(); ++k) {
      const double low = k == 0 ? 0 : 0.5 * (centre[k - 1] + centre[k]);
      const double high =
          k + 1 == centre.size() ? 1.5 * centre[k] - 0.5 * centre[k - 1] : 0.5 * (centre[k] + centre[k + 1]);
      sum += value(static_cast<int>(k), j, i) * density(static_cast<int>(k)) * (high - low);
    }
    return sum;
  }
};

TEST_F(CloudImport, StretchedLevelsKeepTheColumnsOfClassicAndNetcdf4Files) {
  for (const int format : {0, int{NC_64BIT_OFFSET}, int{NC_NETCDF4}}) {
    LesFile les;
    les.format = format;
    for (const std::size_t time : {0, 1}) {
      auto options = options_for(les.write(folder_ / "les.nc"));
      options.time = time;
      const ImportedCloud cloud = import_cloud(options);
      EXPECT_EQ(cloud.field.quantity, "liquid_water_content");
      EXPECT_DOUBLE_EQ(cloud.field.cell_size_m[0], 50);
      EXPECT_DOUBLE_EQ(cloud.field.cell_size_m[1], 40);
      EXPECT_DOUBLE_EQ(cloud.field.min_m[2], 0);
      const std::vector<double> columns = column_integrals(cloud.field);
      for (int j = 0; j < LesFile::ny; ++j) {
        for (int i = 0; i < LesFile::nx; ++i) {
          const double expected = (static_cast<double>(time) + 1) * les.path_of(j, i);
          EXPECT_NEAR(columns[j * LesFile::nx + i] / expected, 1, 1e-6);  // floats in the file and in the field
        }
      }
    }
  }
}

TEST_F(CloudImport, UniformLevelsStayAsTheyAre) {
  LesFile les;
  les.centre = {10, 30, 50, 70, 90, 110, 130};
  const ImportedCloud cloud = import_cloud(options_for(les.write(folder_ / "les.nc")));
  EXPECT_EQ(cloud.field.cells[2], 7);
  EXPECT_DOUBLE_EQ(cloud.field.cell_size_m[2], 20);
  const auto dense = to_dense(cloud.field);
  EXPECT_NEAR(dense[(3 * 2 + 1) * 3 + 2], 0.34e0 * LesFile::density(3), 1e-6);
}

TEST_F(CloudImport, EffectiveRadiusIsThatOfTheDropletsAndKeepsTheOpticalDepth) {
  LesFile les;
  const ImportedCloud cloud = import_cloud(options_for(les.write(folder_ / "les.nc")));
  ASSERT_EQ(cloud.auxiliaries.size(), 1U);
  EXPECT_EQ(cloud.auxiliaries[0].grid, "reff");
  EXPECT_EQ(cloud.auxiliaries[0].units, "um");
  // 1e8 droplets a m3: sum of L / r_e over a column, r_e^3 = 3 L / (4 pi 1e6 g/m3 0.8 1e8) m3.
  double expected = 0, found = 0;
  for (std::size_t n = 0; n < cloud.field.value.size(); ++n) {
    found += cloud.field.value[n] / cloud.auxiliaries[0].value[n] * cloud.field.cell_size_m[2];
  }
  for (int k = 2; k <= 5; ++k) {
    for (int j = 0; j < LesFile::ny; ++j) {
      for (int i = 0; i < LesFile::nx; ++i) {
        const double water = les.value(k, j, i) * LesFile::density(k);
        const double radius = 1e6 * std::cbrt(3 * water / (4 * std::numbers::pi * 1e6 * 0.8 * 1e8));
        expected += water / radius * 0.5 * (les.centre[k + 1] - les.centre[k - 1]);
      }
    }
  }
  EXPECT_NEAR(found / expected, 1, 1e-6);
}

TEST_F(CloudImport, LevelsMayDescendAndBeInKilometres) {
  LesFile up, down;
  for (double& z : down.centre) z /= 1000;
  std::reverse(down.centre.begin(), down.centre.end());
  down.height_units = "km";
  const auto value = up.value;
  down.value = [value](int k, int j, int i) { return value(7 - k, j, i); };
  up.units = down.units = "g m-3";
  const auto a = import_cloud(options_for(up.write(folder_ / "up.nc"))).field;
  const auto b = import_cloud(options_for(down.write(folder_ / "down.nc"))).field;
  ASSERT_EQ(a.cells, b.cells);
  ASSERT_EQ(a.value.size(), b.value.size());
  for (std::size_t n = 0; n < a.value.size(); ++n) EXPECT_NEAR(a.value[n], b.value[n], 1e-5);  // heights are floats
}

TEST_F(CloudImport, UnitsAreHandledOrGuessedAloud) {
  const auto mass = [&](const std::string& units, double factor) {
    LesFile les;
    les.units = units;
    const auto value = les.value;
    les.value = [value, factor](int k, int j, int i) { return factor * value(k, j, i); };
    const ImportedCloud cloud = import_cloud(options_for(les.write(folder_ / "les.nc")));
    const bool guessed = std::any_of(cloud.notes.begin(), cloud.notes.end(), [](const auto& note) {
      return note.find("GUESSED unit of 'QC'") != std::string::npos;
    });
    EXPECT_EQ(guessed, units.empty());
    return column_integrals(cloud.field)[0];
  };
  const double expected = LesFile{}.path_of(0, 0);
  EXPECT_NEAR(mass("kg kg-1", 1e-3) / expected, 1, 1e-6);
  EXPECT_NEAR(mass("kg/kg", 1e-3) / expected, 1, 1e-6);
  EXPECT_NEAR(mass("g kg^-1", 1) / expected, 1, 1e-6);
  EXPECT_NEAR(mass("", 1e-3) / expected, 1, 1e-6);
  EXPECT_NEAR(mass("", 1) / expected, 1, 1e-6);
  EXPECT_NEAR(mass("kg m-3", 1e-3), mass("g/m3", 1), 1e-6 * mass("g/m3", 1));
}

TEST_F(CloudImport, WrongLesFilesAreErrorsThatSayWhy) {
  const auto error = [&](const std::function<void(LesFile&, CloudImportOptions&)>& spoil) {
    LesFile les;
    CloudImportOptions options;
    spoil(les, options);
    options.file = les.write(folder_ / "les.nc");
    return message_of([&] { import_cloud(options); });
  };
  for (const int format : {0, int{NC_NETCDF4}}) {
    const auto spoiled = [&](const std::function<void(LesFile&)>& spoil) {
      return error([&](LesFile& les, CloudImportOptions&) {
        les.format = format;
        spoil(les);
      });
    };
    EXPECT_THAT(spoiled([](LesFile& les) { les.units = "K"; }), HasSubstr("unit not known (found 'K'"));
    EXPECT_THAT(spoiled([](LesFile& les) { les.water = "W"; }), HasSubstr("no variable of liquid water"));
    EXPECT_THAT(spoiled([](LesFile& les) { les.times = 0; }), HasSubstr("time axis 'time' has length 0"));
    EXPECT_THAT(spoiled([](LesFile& les) { les.with_density = false; }), HasSubstr("--air-density"));
    EXPECT_THAT(spoiled([](LesFile& les) { les.centre[4] = les.centre[3]; }), HasSubstr("not monotonic"));
    EXPECT_THAT(spoiled([](LesFile& les) { les.value = [](int k, int, int) { return k == 3 ? std::nan("") : 0.1; }; }),
                HasSubstr("cell (0, 0, 3) has the value NaN"));
    EXPECT_THAT(spoiled([](LesFile& les) { les.value = [](int k, int, int) { return k == 3 ? -0.1 : 0.1; }; }),
                HasSubstr("cell (0, 0, 3) has the value -0.1"));
    EXPECT_THAT(spoiled([](LesFile& les) { les.value = [](int, int, int) { return 0.0; }; }), HasSubstr("no cloud"));
  }
  EXPECT_THAT(error([](LesFile&, CloudImportOptions& options) { options.time = 2; }),
              HasSubstr("found 2, allowed 0 to 1"));
  EXPECT_THAT(error([](LesFile&, CloudImportOptions& options) { options.variable = "ql"; }),
              HasSubstr("no variable 'ql'"));
  EXPECT_THAT(message_of([&] { import_cloud(options_for(folder_ / "none.nc")); }), HasSubstr("no such file"));
}

TEST_F(CloudImport, FilesThatAreCutOffAreErrors) {
  for (const int format : {0, int{NC_NETCDF4}}) {
    LesFile les;
    les.format = format;
    const auto path = les.write(folder_ / "les.nc");
    const auto whole = std::filesystem::file_size(path);
    for (const auto part : {whole / 3, whole / 2, whole * 3 / 4}) {
      les.write(path);
      std::filesystem::resize_file(path, part);
      EXPECT_THROW(import_cloud(options_for(path)), InputError) << format << " cut to " << part;
    }
  }
}

TEST_F(CloudImport, SizesThatTheUserGivesHoldOverTheFilesLevels) {
  auto options = options_for(write("a.lwc", "1 parameter LWC file\n1 1 2\n0.1 0.1\n0.5 0.6\n290 289\n1 1 2 0.3\n"));
  options.voxel_size_m = {20, 20, 30};
  EXPECT_NEAR(import_cloud(options).field.cell_size_m[2], 100, 1e-9);  // of columns alone
  options.levels_by_voxel_size = true;
  const ImportedCloud cloud = import_cloud(options);
  EXPECT_EQ(cloud.field.cell_size_m, (std::array<double, 3>{20, 20, 30}));
  EXPECT_THAT(cloud.notes, testing::Contains(HasSubstr("in place of the file's 450 to 650 m")));
  options.file =
      write("cells.csv", "ix,iz,z_bottom_km,z_top_km,extinction_per_km\n0,0,0.40,0.45,10\n0,1,0.45,0.475,20\n");
  EXPECT_THAT(import_cloud(options).field.value, testing::ElementsAre(0.01F, 0.02F));
  EXPECT_EQ(import_cloud(options).field.cell_size_m[2], 30);
}

TEST_F(CloudImport, ReferenceFields) {
  const char* folder = std::getenv("CLOUDBOW_REFERENCE_DIR");
  if (folder == nullptr) GTEST_SKIP() << "CLOUDBOW_REFERENCE_DIR is not set";
  const std::filesystem::path fields = std::filesystem::path(folder) / "fields";
  const ImportedCloud cloud = import_cloud(options_for(fields / "stcu213_optics" / "optics_nonzero.csv"));
  const CloudField same = read_cloud_vdb(fields / "stcu213.vdb");
  EXPECT_EQ(cloud.field.cells[0], same.cells[0]);
  EXPECT_EQ(cloud.field.cell_size_m[2], same.cell_size_m[2]);
  ASSERT_EQ(cloud.field.value.size(), same.value.size());
  for (std::size_t n = 0; n < same.value.size(); ++n) EXPECT_NEAR(cloud.field.value[n] / same.value[n], 1, 1e-5);

  auto options = options_for(fields / "les2d_cells.csv");
  options.columns = {64, 1};
  options.voxel_size_m = {55, 55, 55};
  const ImportedCloud les2d = import_cloud(options);
  EXPECT_NEAR(les2d.field.cell_size_m[2], 25, 1e-9);
  EXPECT_EQ(les2d.field.value.size(), 476U);
}

}  // namespace
}  // namespace cloudbow
