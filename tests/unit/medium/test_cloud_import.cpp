// Clouds of others. Truths: sums over the levels as they are written here (columns keep their mass); closed forms of
// the effective radius; and the fields of tests' reference folder if it exists.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <numbers>

#include "cloud_test_tools.hpp"
#include "cloudbow/medium/cloud_import.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

/// A folder of one test, gone with it.
class CloudImport : public testing::Test {
 protected:
  CloudImport() {
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("cloudbow-import-") + testing::UnitTest::GetInstance()->current_test_info()->name() + "-" +
               std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~CloudImport() override {
    std::error_code error;
    std::filesystem::remove_all(folder_, error);
  }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  static CloudImportOptions options_for(const std::filesystem::path& file) {
    CloudImportOptions options;
    options.file = file;
    return options;
  }

  std::filesystem::path folder_;
};

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

TEST_F(CloudImport, TextColumns) {
  auto options = options_for(write("cloud.txt", "# i j k value\ni j k extinction\n0 0 1 0.5\n2 1 3 0.25\n"));
  options.format = "columns";
  options.voxel_size_m = {20, 30, 40};
  options.columns = {4, 2};
  const CloudField field = import_cloud(options).field;
  EXPECT_EQ(field.cells, (std::array<int, 3>{4, 2, 4}));
  EXPECT_EQ(field.quantity, "extinction");
  EXPECT_EQ(column_integrals(field), (std::vector<double>{20, 0, 0, 0, 0, 0, 10, 0}));

  options.file = write("commas.txt", ",,\n0 0 1 0.5\n , ,\n2 1 3 0.25\n");  // no words, as in a blank line
  EXPECT_EQ(import_cloud(options).field.active_voxels(), 2U);

  const auto error = [&](const std::string& text) {
    options.file = write("wrong.txt", text);
    return message_of([&] { import_cloud(options); });
  };
  EXPECT_THAT(error("0 0 0 1\n0 0 1\n"), HasSubstr("wrong.txt:2: not four numbers"));
  EXPECT_THAT(error("0 0 0 -1\n"), HasSubstr("value is -1"));
  EXPECT_THAT(error("0 0 0 nan\n"), HasSubstr("value is nan"));
  EXPECT_THAT(error("0 0 -1 1\n"), HasSubstr("index along z out of range"));
  EXPECT_THAT(error("9 0 0 1\n"), HasSubstr("outside the domain"));
  EXPECT_THAT(error("0 0 0 1\n0 0 0 1\n"), HasSubstr("there twice"));
  options.memory_limit_bytes = 100'000;
  EXPECT_THAT(error("0 0 1000 1\n"), HasSubstr("too large for the memory (found 4 x 2 x 1001 cells"));
  options.voxel_size_m.reset();
  EXPECT_THAT(error("0 0 0 1\n"), HasSubstr("--voxel-size-m"));
}

TEST_F(CloudImport, CellsWithOpticsOnStretchedLevels) {
  auto options = options_for(write("cells.csv",
                                   "ix,iz,z_bottom_km,z_top_km,extinction_per_km,ssa,phase_index\n"
                                   "0,0,0.40,0.45,10,0.9,2\n0,1,0.45,0.475,20,0.8,3\n1,2,0.475,0.5,40,1,4\n"));
  options.columns = {3, 1};
  options.voxel_size_m = {55, 55, 55};
  const ImportedCloud cloud = import_cloud(options);
  EXPECT_EQ(cloud.field.cells, (std::array<int, 3>{3, 1, 4}));  // of 25 m: exact
  EXPECT_NEAR(cloud.field.min_m[2], 400, 1e-9);
  EXPECT_THAT(cloud.field.value, testing::ElementsAre(0.01F, 0.01F, 0.02F, 0.04F));
  ASSERT_EQ(cloud.auxiliaries.size(), 2U);
  EXPECT_THAT(cloud.auxiliaries[0].value, testing::ElementsAre(0.9F, 0.9F, 0.8F, 1.0F));
  EXPECT_THAT(cloud.auxiliaries[1].value, testing::ElementsAre(2, 2, 3, 4));
  // Coarser: extinction and scattering of the column stay.
  options.vertical_size_m = 50;
  const ImportedCloud coarse = import_cloud(options);
  EXPECT_NEAR(column_integrals(coarse.field)[0], 1.0, 1e-6);
  double scattering = 0;
  for (std::size_t n = 0; n < coarse.field.value.size(); ++n) {
    scattering += coarse.field.value[n] * coarse.auxiliaries[0].value[n] * 50;
  }
  EXPECT_NEAR(scattering, 0.5 * 0.9 + 0.5 * 0.8 + 1, 1e-6);
}

TEST_F(CloudImport, ShdomPropertyFile) {
  const std::string head =
      "Tabulated phase function property file\n 2 1 3\n 0.02 0.03  0.1 0.14 0.18\n 2\n 2 1.5 0.5\n 3 2.4\n 1.5\n 0.7\n";
  const ImportedCloud cloud = import_cloud(
      options_for(write("a.prp", head + "1 1 2 290.0 5.0 0.99 2\n2 1 2 290.0 10.0 0.9 1\n1 1 1 290 0 1 1\n")));
  EXPECT_EQ(cloud.field.cells, (std::array<int, 3>{2, 1, 3}));
  EXPECT_NEAR(cloud.field.min_m[2], 80, 1e-9);
  EXPECT_NEAR(cloud.field.cell_size_m[2], 40, 1e-9);
  EXPECT_THAT(cloud.field.value, testing::ElementsAre(0.005F, 0.01F));
  EXPECT_THAT(cloud.auxiliaries[0].value, testing::ElementsAre(0.99F, 0.9F));
  EXPECT_THAT(cloud.auxiliaries[1].value, testing::ElementsAre(2, 1));
  ASSERT_EQ(cloud.moments.size(), 2U);
  EXPECT_THAT(cloud.moments[0], testing::ElementsAre(1, 0.5, 0.1));
  EXPECT_THAT(cloud.moments[1],
              testing::ElementsAre(1, testing::DoubleEq(0.8), testing::DoubleEq(0.3), testing::DoubleEq(0.1)));

  const auto error = [&](const std::string& text) {
    return message_of([&] { import_cloud(options_for(write("b.prp", text))); });
  };
  EXPECT_THAT(error(head + "3 1 2 290.0 5.0 0.99 2\n"),
              HasSubstr("b.prp:9: index along x out of range (found 3, allowed 1 to 2)"));
  EXPECT_THAT(error(head + "1 1 2 290.0 5.0 1.2 2\n"), HasSubstr("single-scattering albedo is 1.2"));
  EXPECT_THAT(error(head + "1 1 2 290.0 5.0 1 3\n"), HasSubstr("allowed 1 to 2"));
  EXPECT_THAT(error(head.substr(0, 75)), HasSubstr("the file ends before"));
  EXPECT_THAT(error("Quick property file\n"), HasSubstr("begins with 'Q'"));
}

TEST_F(CloudImport, ShdomWaterFiles) {
  const std::string grid = "1 1 2\n0.1 0.1\n0.5 0.6\n290 289\n";
  const auto one = import_cloud(options_for(write("1.lwc", "1 parameter LWC file\n" + grid + "1 1 2 0.3\n")));
  EXPECT_EQ(one.field.quantity, "liquid_water_content");
  EXPECT_THAT(one.field.value, testing::ElementsAre(0.3F));
  EXPECT_TRUE(one.auxiliaries.empty());
  const auto two =
      import_cloud(options_for(write("2.lwc", "2 parameter LWC file\n" + grid + "1 1 1 0.3 8\n1 1 2 0.0 0\n")));
  EXPECT_THAT(two.auxiliaries.at(0).value, testing::ElementsAre(8));
  const auto three = import_cloud(
      options_for(write("3.part", "3 propgen particle file\n" + grid + "1 1 1 2 1 0.3 8 2 0.1 40\n1 1 2 0\n")));
  EXPECT_THAT(three.field.value, testing::ElementsAre(0.3F));
  EXPECT_THAT(three.auxiliaries.at(0).value, testing::ElementsAre(8));
}

TEST_F(CloudImport, TextIsReadAsFortranWritesIt) {
  const std::string whole = "1 parameter LWC file\n2 1 3\n0.1 0.1\n0.5 0.6 0.7\n290 290 290\n1 1 2 0.3\n";
  const std::string listed = "1 PARAMETER LWC FILE\n2 1 3\n2*1.0D-1\n5.0d-1 .6 7.D-1\n3*290\n2*1 2 3.0D-01\n";
  const CloudField a = import_cloud(options_for(write("a.lwc", whole))).field;
  const CloudField b = import_cloud(options_for(write("b.lwc", listed))).field;
  EXPECT_EQ(a.value, b.value);
  EXPECT_EQ(a.cells, b.cells);
  EXPECT_EQ(a.min_m, b.min_m);
  EXPECT_EQ(import_cloud(options_for(write("c.prp",
                                           "e: extinction only PROPERTY FILE\n1 1 2\n.1 .1 .5 .6\n2*280\n"
                                           "1.0 1 1.5\n1 1 1 5.0D0\n")))
                .field.quantity,
            "extinction");
  auto options = options_for(write("columns.txt", "2*0 1 5.0D-1\n2 1 3 2.5d-1\n"));
  options.voxel_size_m = {20, 30, 40};
  EXPECT_THAT(import_cloud(options).field.value, testing::ElementsAre(0.5F, 0.25F));
  options.file = write("many.txt", "0 0 0 1\n1000001*0\n");
  EXPECT_THAT(message_of([&] { import_cloud(options); }), HasSubstr("many.txt:2: not four numbers"));
  options.file = write("repeats.txt", "0 0 0 1\n999999*0 999999*0\n");
  EXPECT_THAT(message_of([&] { import_cloud(options); }), HasSubstr("too many numbers"));
}

TEST_F(CloudImport, TextBelowAHeadOfSizesAndLevels) {
  const std::string head = "# cloud\n2,2,3 # nx,ny,nz\n0.02,0.03 # dx,dy [km, km]\n0.44,0.48,0.52 # levels [km]\n";
  const std::string columns = "x,y,z,lwc,reff\n";
  const ImportedCloud at3d =
      import_cloud(options_for(write("at3d.csv", head + columns + "0,0,1,0.5,10.0\n1,1,2,0.3,8.0\n")));
  EXPECT_EQ(at3d.field.cells, (std::array<int, 3>{2, 2, 3}));
  EXPECT_EQ(at3d.field.quantity, "liquid_water_content");
  EXPECT_NEAR(at3d.field.cell_size_m[1], 30, 1e-9);
  EXPECT_NEAR(at3d.field.min_m[2], 420, 1e-9);
  EXPECT_THAT(at3d.field.value, testing::ElementsAre(0.5F, 0.3F));
  EXPECT_THAT(at3d.auxiliaries.at(0).value, testing::ElementsAre(10, 8));
  EXPECT_THAT(column_integrals(at3d.field),
              testing::ElementsAre(testing::DoubleNear(20, 1e-6), 0, 0, testing::DoubleNear(12, 1e-6)));

  const ImportedCloud mystic =
      import_cloud(options_for(write("wc3d.dat", "2 2 2 3\n0.1 0.1 0.5 0.6 0.7\n1 1 1 0.5 10.0\n2 1 2 0.3 8.0\n")));
  EXPECT_EQ(mystic.field.cells, (std::array<int, 3>{2, 2, 2}));
  EXPECT_NEAR(mystic.field.min_m[2], 500, 1e-9);
  EXPECT_THAT(mystic.auxiliaries.at(0).value, testing::ElementsAre(10, 8));
  const ImportedCloud optics =
      import_cloud(options_for(write("wc3d.dat", "1 1 2 1\n0.1 0.1 0.5 0.6 0.7\n1 1 1 20 0.85 0.99\n")));
  EXPECT_EQ(optics.field.quantity, "extinction");
  EXPECT_THAT(optics.field.value, testing::ElementsAre(0.02F));
  EXPECT_THAT(optics.auxiliaries.at(0).value, testing::ElementsAre(0.99F));

  const auto error = [&](const std::string& text) {
    return message_of([&] { import_cloud(options_for(write("wrong.txt", text))); });
  };
  EXPECT_THAT(error(head + columns + "0,0,3,0.5,10\n"), HasSubstr("wrong.txt:6: index along z out of range"));
  EXPECT_THAT(error(head + columns + "0,0,1,50,10\n"), HasSubstr("(allowed up to 20 g/m3)"));
  EXPECT_THAT(error(head + columns + "0,0,1,0.5,1e-5\n"), HasSubstr("(allowed 0.1 to 5000 um)"));
  EXPECT_THAT(error(head + columns + "0,0,1,0.5,10\n0,0,1,0.5,10\n"), HasSubstr("there twice"));
  EXPECT_THAT(error("1 1 2 3\n0.1 0.1 0.5 0.6 0.6\n1 1 1 0.5 10\n"), HasSubstr("levels do not ascend"));
  EXPECT_THAT(error("1 1 2 3\n0.1 0.1 500 600 70000\n1 1 1 0.5 10\n"), HasSubstr("m thick"));
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

/// An archive of one stored array "lwc" of two numbers, 0.5 and 0.25, as numpy.savez writes it.
std::string small_archive() {
  const auto number = [](std::uint32_t value, int bytes) {
    std::string text;
    for (int n = 0; n < bytes; ++n) text += static_cast<char>(value >> (8 * n) & 255);
    return text;
  };
  std::string head = "{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }";
  head.resize(117, ' ');
  const std::string array =
      std::string("\x93NUMPY\x01\x00\x76\x00", 10) + head + "\n" + std::string("\0\0\0\x3f\0\0\x80\x3e", 8);
  // CRC-32 of IEEE 802.3, bit by bit.
  std::uint32_t checksum = 0xffffffff;
  for (const char c : array) {
    checksum ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) checksum = (checksum >> 1) ^ (checksum & 1 ? 0xedb88320 : 0);
  }
  const auto bytes = static_cast<std::uint32_t>(array.size());
  const std::string name = "lwc.npy", zeros(64, '\0');
  const std::string about =
      number(20, 2) + zeros.substr(0, 8) + number(~checksum, 4) + number(bytes, 4) + number(bytes, 4) + number(7, 2);
  const std::string member = "PK\x03\x04" + about + zeros.substr(0, 2) + name + array;
  const std::string directory = "PK\x01\x02" + number(20, 2) + about + zeros.substr(0, 16) + name;
  return member + directory + "PK\x05\x06" + zeros.substr(0, 4) + number(1, 2) + number(1, 2) +
         number(static_cast<std::uint32_t>(directory.size()), 4) +
         number(static_cast<std::uint32_t>(member.size()), 4) + zeros.substr(0, 2);
}

TEST_F(CloudImport, ArchivesOfNumpy) {
  const std::string archive = small_archive();
  CloudImportOptions options = options_for(write("a.npz", archive));
  options.voxel_size_m = {10, 20, 30};
  const CloudField found = import_cloud(options).field;
  EXPECT_EQ(found.quantity, "liquid_water_content");
  EXPECT_EQ(found.cells, (std::array<int, 3>{1, 1, 2}));
  EXPECT_THAT(found.value, testing::ElementsAre(0.5F, 0.25F));
  options.variable = "qc";
  EXPECT_THAT(message_of([&] { import_cloud(options); }),
              HasSubstr("no array 'qc' (as --variable says; arrays in the file: lwc)"));
  options.variable.clear();
  // Every shortened archive and every changed byte is refused, or changes nothing that counts.
  for (std::size_t n = 4; n < archive.size(); ++n) {
    options.file = write("cut.npz", archive.substr(0, n));
    EXPECT_NE(message_of([&] { import_cloud(options); }), "") << n;
    std::string changed = archive;
    changed[n] = static_cast<char>(changed[n] ^ 0x55);
    options.file = write("changed.npz", changed);
    try {
      EXPECT_THAT(import_cloud(options).field.value, testing::ElementsAre(0.5F, 0.25F)) << n;
    } catch (const InputError& error) {
      EXPECT_THAT(std::string(error.what()), HasSubstr("changed.npz")) << n;
    }
  }
}

TEST_F(CloudImport, ArraysOfNumpy) {
  // Files as numpy.save writes them: the header is padded so that numbers begin at a multiple of 64 bytes.
  const auto array = [&](const std::string& type, const std::string& order, const std::string& shape,
                         const std::string& numbers) {
    std::string head = "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': (" + shape + "), }";
    head.resize(117, ' ');
    return options_for(write("a.npy", std::string("\x93NUMPY\x01\x00\x76\x00", 10) + head + "\n" + numbers));
  };
  const auto bytes_of = [](const auto& values, bool reversed = false) {
    std::string bytes;
    for (const auto value : values) {
      std::string one(reinterpret_cast<const char*>(&value), sizeof value);
      if (reversed) std::reverse(one.begin(), one.end());
      bytes += one;
    }
    return bytes;
  };
  const std::vector<double> numbers{1, 2, 3, 4, 5, 6};  // [z][y][x], 3 x 1 x 2
  const std::vector<double> by_columns{1, 3, 5, 2, 4, 6};
  const std::vector<float> single{1, 2, 3, 4, 5, 6};
  EXPECT_THAT(message_of([&] { import_cloud(array("<f8", "False", "3, 1, 2", bytes_of(numbers))); }),
              HasSubstr("--voxel-size-m DX DY DZ"));
  const auto expect_read = [&](CloudImportOptions options) {
    options.voxel_size_m = {10, 20, 30};
    options.quantity = "liquid_water_content";
    const CloudField found = import_cloud(options).field;
    EXPECT_EQ(found.cells, (std::array<int, 3>{2, 1, 3}));
    EXPECT_EQ(found.quantity, "liquid_water_content");
    EXPECT_THAT(found.value, testing::ElementsAre(1, 2, 3, 4, 5, 6));
  };
  expect_read(array("<f8", "False", "3, 1, 2", bytes_of(numbers)));
  expect_read(array("<f8", "True", "3, 1, 2", bytes_of(by_columns)));
  expect_read(array("<f4", "False", "3, 2", bytes_of(single)));
  expect_read(array(">f4", "False", "3, 2", bytes_of(single, true)));
  const auto error = [&](CloudImportOptions options) {
    options.voxel_size_m = {10, 20, 30};
    return message_of([&] { import_cloud(options); });
  };
  EXPECT_THAT(error(array("<f8", "False", "3, 1, 3", bytes_of(numbers))), HasSubstr("the file is cut off"));
  EXPECT_THAT(error(array("<i8", "False", "3, 1, 2", bytes_of(numbers))), HasSubstr("numbers of type <i8"));
  EXPECT_THAT(error(array("<f8", "False", "3, 1, 2, 1", bytes_of(numbers))), HasSubstr("4 dimensions"));
  EXPECT_THAT(error(array("<f8", "False", "-3, 1, 2", bytes_of(numbers))), HasSubstr("no cells"));
  EXPECT_THAT(error(array("<f8", "False", "2", bytes_of(std::vector<double>{1, -1}))),
              HasSubstr("cell (0, 0, 1) has the value -1"));
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
