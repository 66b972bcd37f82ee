// Tables of droplets as files. Truth: the data written; tables of other programs' forms, made here value by value.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <netcdf.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/droplet_table_file.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class DropletTableFile : public testing::Test {
 protected:
  DropletTableFile() {
    folder_ = std::filesystem::temp_directory_path() / ("cloudbow-droplets-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~DropletTableFile() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write_text(const std::string& text) const {
    std::ofstream(folder_ / "table.txt") << text;
    return folder_ / "table.txt";
  }

  static std::string message(const std::filesystem::path& file, std::optional<double> wavelength = std::nullopt) {
    try {
      read_droplet_table(file, wavelength);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  std::filesystem::path folder_;
};

DropletTable small_table() {
  return {0.67, {6, 12}, {0.27, 0.13}, {1 - 1e-12, 0.75}, {{1, 0.25, 0.01}, {1, 0.25, 0.125, 0.003}}};
}

DropletTableInfo some_info() { return {{1.331, 2e-8}, "somewhere", 1, "gamma", 0.1, "cloudbow", "cloudbow mie"}; }

TEST_F(DropletTableFile, ReadsWhatItWrote) {
  const auto file = folder_ / "table.h5";
  write_droplet_table(file, small_table(), some_info());
  const DropletTable table = read_droplet_table(file);
  EXPECT_EQ(table.wavelength_um, 0.67);
  EXPECT_EQ(table.effective_radius_um, small_table().effective_radius_um);
  EXPECT_EQ(table.extinction_m2_per_g, small_table().extinction_m2_per_g);
  EXPECT_EQ(table.single_scattering_albedo, small_table().single_scattering_albedo);
  EXPECT_EQ(table.moments, small_table().moments);
  EXPECT_NO_THROW(read_droplet_table(file, 0.67));
  EXPECT_THAT(message(file, 0.55), AllOf(HasSubstr("table.h5"), HasSubstr("found 0.55"), HasSubstr("0.67")));
}

TEST_F(DropletTableFile, HoldsSeveralWavelengths) {
  const auto file = folder_ / "table.h5";
  DropletTable blue = small_table();
  blue.wavelength_um = 0.45;
  blue.extinction_m2_per_g = {0.26, 0.125};
  blue.moments = {{1, 0.5, 0.125, 0.01, 0.002}, {1, 0.3, 0.01}};
  DropletTableInfo blue_info = some_info();
  blue_info.refractive_index = {1.337, 1e-9};
  write_droplet_tables(file, std::vector{small_table(), blue}, std::vector{some_info(), blue_info});
  for (const DropletTable& expected : {small_table(), blue}) {
    const DropletTable table = read_droplet_table(file, expected.wavelength_um);
    EXPECT_EQ(table.wavelength_um, expected.wavelength_um);
    EXPECT_EQ(table.effective_radius_um, expected.effective_radius_um);
    EXPECT_EQ(table.extinction_m2_per_g, expected.extinction_m2_per_g);
    EXPECT_EQ(table.single_scattering_albedo, expected.single_scattering_albedo);
    EXPECT_EQ(table.moments, expected.moments);
  }
  EXPECT_THAT(message(file, 0.55), AllOf(HasSubstr("table.h5"), HasSubstr("found 0.55"), HasSubstr("nearest")));
  EXPECT_THAT(message(file, {}), HasSubstr("2 wavelengths"));
}

TEST_F(DropletTableFile, IsNetcdf4) {
  const auto file = folder_ / "table.h5";
  write_droplet_table(file, small_table(), some_info());
  int id = 0, variable = 0, dimension = 0;
  ASSERT_EQ(nc_open(file.c_str(), NC_NOWRITE, &id), NC_NOERR);
  for (const char* name : {"effective_radius", "moment", "angle"})
    EXPECT_EQ(nc_inq_dimid(id, name, &dimension), 0) << name;
  ASSERT_EQ(nc_inq_varid(id, "phase_function", &variable), NC_NOERR);
  const std::vector<double> angle = droplet_table_angles();
  std::vector<double> phase(2 * angle.size());
  ASSERT_EQ(nc_get_var_double(id, variable, phase.data()), NC_NOERR);
  nc_close(id);
  // P = 1 + 3 chi_1 + 5 chi_2 + ... straight on; alternating backwards.
  EXPECT_NEAR(phase[0], 1 + 3 * 0.25 + 5 * 0.01, 1e-6);
  EXPECT_NEAR(phase.back(), 1 - 3 * 0.25 + 5 * 0.125 - 7 * 0.003, 1e-6);
  EXPECT_EQ(angle.front(), 0);
  EXPECT_EQ(angle.back(), 180);
  EXPECT_TRUE(std::is_sorted(angle.begin(), angle.end()));
}

TEST_F(DropletTableFile, SaysWhatIsWrongWithAFile) {
  EXPECT_THAT(message(folder_ / "none.h5"), HasSubstr("no such file"));
  EXPECT_THAT(message(folder_), HasSubstr("a directory"));
  EXPECT_THAT(message(write_text("")), HasSubstr("not a table of droplets"));
  EXPECT_THAT(message(write_text("1 2 3\n")), HasSubstr("not a table of droplets"));
  EXPECT_THAT(message(write_text("\x89HDF\r\n\x1a\nand then nothing")), HasSubstr("table.txt: damaged"));
  EXPECT_THAT(message(write_text("CDF\x01 and then nothing")), HasSubstr("damaged"));

  const auto file = folder_ / "table.h5";
  write_droplet_table(file, small_table(), some_info());
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  EXPECT_THAT(message(file), HasSubstr("damaged"));
  write_droplet_table(file, small_table(), some_info());
  const hid_t handle = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  H5Ldelete(handle, "single_scattering_albedo", H5P_DEFAULT);
  H5Fclose(handle);
  EXPECT_THAT(message(file), HasSubstr("no variable 'single_scattering_albedo'"));
}

/// Contents of a file in the form of libRadtran's mie: two wavelengths, two radii, two matrix elements, four moments.
struct LibradtranFile {
  std::vector<double> reff = {5, 10};
  std::vector<double> ssa = {0.9, 0.8, 0.99, 0.98};
  std::vector<double> ext = {300, 150, 301, 151};  // 1/km for 1 g/m3
  std::vector<double> pmom = {1, 1.2,   0.5, 0.05, 9, 9, 9, 9, 1, 1.05, 0.4, 0.05,  9, 9, 9, 9,
                              1, 1.275, 0.6, 0.06, 9, 9, 9, 9, 1, 1.35, 0.7, 0.063, 9, 9, 9, 9};
  std::vector<double> gg{};  // empty: none
  const char* pmom_units = "including factor 2*l+1";
  const char* ext_units = "km^-1/(g/m^3)";
  const char* without = "";  // a variable to leave out
  const char* axis = "reff";
  int format = NC_CLOBBER;

  void write(const std::filesystem::path& path) const {
    int id = 0, lambda = 0, radius = 0, element = 0, moment = 0;
    ASSERT_EQ(nc_create(path.c_str(), format, &id), NC_NOERR);
    nc_def_dim(id, "nlam", 2, &lambda);
    nc_def_dim(id, "nreff", reff.size(), &radius);
    nc_def_dim(id, "nphamat", 2, &element);
    nc_def_dim(id, "nmommax", 4, &moment);
    const auto define = [&](const std::string& name, std::vector<int> dimensions, nc_type type) {
      int variable = -1;
      if (name != without) {
        nc_def_var(id, name.c_str(), type, static_cast<int>(dimensions.size()), dimensions.data(), &variable);
      }
      return variable;
    };
    const int v_lambda = define("wavelen", {lambda}, NC_DOUBLE), v_radius = define(axis, {radius}, NC_DOUBLE);
    const int v_ext = define("ext", {lambda, radius}, NC_DOUBLE), v_ssa = define("ssa", {lambda, radius}, NC_DOUBLE);
    const int v_nmom = define("nmom", {lambda, radius, element}, NC_INT);
    const int v_gg = gg.empty() ? -1 : define("gg", {lambda, radius}, NC_DOUBLE);
    const int v_pmom = define("pmom", {lambda, radius, element, moment}, NC_FLOAT);
    if (v_ext >= 0) nc_put_att_text(id, v_ext, "units", std::string(ext_units).size(), ext_units);
    if (v_pmom >= 0) nc_put_att_text(id, v_pmom, "units", std::string(pmom_units).size(), pmom_units);
    nc_enddef(id);
    const std::vector<double> wavelength{0.55, 0.67};
    const std::vector<int> nmom(8, 4);
    nc_put_var_double(id, v_lambda, wavelength.data());
    nc_put_var_double(id, v_radius, reff.data());
    if (v_ext >= 0) nc_put_var_double(id, v_ext, ext.data());
    nc_put_var_double(id, v_ssa, ssa.data());
    nc_put_var_int(id, v_nmom, nmom.data());
    if (v_pmom >= 0) nc_put_var_double(id, v_pmom, pmom.data());
    if (v_gg >= 0) nc_put_var_double(id, v_gg, gg.data());
    nc_close(id);
  }
};

TEST_F(DropletTableFile, ReadsLibradtran) {
  for (const int format : {NC_CLOBBER, NC_CLOBBER | NC_64BIT_OFFSET, NC_CLOBBER | NC_NETCDF4}) {
    LibradtranFile content;
    content.format = format;
    content.write(folder_ / "wc.mie.cdf");
    const DropletTable table = read_droplet_table(folder_ / "wc.mie.cdf", 0.67);
    EXPECT_EQ(table.wavelength_um, 0.67);
    EXPECT_EQ(table.effective_radius_um, (std::vector<double>{5, 10}));
    EXPECT_NEAR(table.extinction_m2_per_g[1], 0.151, 1e-15);  // 151 1/km for 1 g/m3
    EXPECT_EQ(table.single_scattering_albedo[0], 0.99);
    // The first matrix element only, the factor 2l+1 taken out; floats.
    EXPECT_NEAR(table.moments[0][1], 1.275 / 3, 1e-7);
    EXPECT_NEAR(table.moments[1][3], 0.063 / 7, 1e-8);
    EXPECT_EQ(table.moments[0].size(), 4u);
    EXPECT_THAT(message(folder_ / "wc.mie.cdf"), HasSubstr("2 wavelengths from 0.55 to 0.67 um"));
    EXPECT_THAT(message(folder_ / "wc.mie.cdf", 0.6), HasSubstr("no such wavelength"));
  }
}

TEST_F(DropletTableFile, ReadsUnitsAndHeadsHoweverTheyAreSpelled) {
  for (const char* units : {"km-1/(g/m3)", "km^-1 / (g/m^3)", "1/km/(g/m3)", "km**-1/(g/m**3)"}) {
    LibradtranFile content;
    content.ext_units = units;
    content.write(folder_ / "wc.mie.cdf");
    EXPECT_NEAR(read_droplet_table(folder_ / "wc.mie.cdf", 0.67).extinction_m2_per_g[1], 0.151, 1e-15) << units;
  }
  const DropletTable table = read_droplet_table(
      write_text("! MIE SCATTERING TABLE VS. EFFECTIVE RADIUS (LWC=1 G/M^3)\n 0.860 0.860 WAVELENGTH RANGE\n"
                 " 1 5.0 5.0 NUMBER, STARTING, ENDING EFFECTIVE RADIUS\n"
                 " 5.0 3.0D+2 0.99 3 REFF EXT ALB NLEG\n 1.0 1.5 0.75 0.05\n"),
      std::nullopt);
  EXPECT_EQ(table.wavelength_um, 0.86);
  EXPECT_NEAR(table.extinction_m2_per_g[0], 0.3, 1e-15);
}

TEST_F(DropletTableFile, SaysThatAFileIsLocked) {
  const auto file = folder_ / "table.h5";
  write_droplet_table(file, small_table(), some_info());
  const int writer = open(file.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(flock(writer, LOCK_EX), 0);
  EXPECT_THAT(message(file), HasSubstr("is locked"));
  close(writer);
}

TEST_F(DropletTableFile, SaysWhatIsWrongWithLibradtransForm) {
  const auto file = folder_ / "wc.mie.cdf";
  const auto message_after = [&](const std::function<void(LibradtranFile&)>& spoil) {
    LibradtranFile content;
    spoil(content);
    content.write(file);
    return message(file, 0.67);
  };
  EXPECT_THAT(message_after([](auto& content) { content.without = "pmom"; }), HasSubstr("no variable 'pmom'"));
  EXPECT_THAT(message_after([](auto& content) { content.without = "ext"; }), HasSubstr("no variable 'ext'"));
  EXPECT_THAT(message_after([](auto& content) { content.ext_units = "m^2/kg"; }), HasSubstr("unknown unit"));
  EXPECT_THAT(message_after([](auto& content) { content.reff = {10, 5}; }), HasSubstr("do not ascend"));
  EXPECT_THAT(message_after([](auto& content) { content.pmom[16] = 0.5; }), HasSubstr("wrong norm"));
  EXPECT_THAT(message_after([](auto& content) { content.pmom[19] = 3.5; }), HasSubstr("too few moments"));
  EXPECT_THAT(message_after([](auto& content) { content.ssa[2] = 2; }), HasSubstr("single-scattering albedo"));
}

// Without the factor, as other writers of the form have it: recognised by missing units and first moments below 1.
TEST_F(DropletTableFile, TellsMomentsWithoutTheFactor) {
  LibradtranFile content;
  content.pmom_units = "-";
  content.pmom = {1, 0.4,  0.1,  0.008, 0, 0, 0, 0, 1, 0.3, 0.1, 0.006, 0, 0, 0, 0,
                  1, 0.42, 0.12, 0.008, 0, 0, 0, 0, 1, 0.3, 0.1, 0.006, 0, 0, 0, 0};
  content.write(folder_ / "wc.mie.cdf");
  const DropletTable table = read_droplet_table(folder_ / "wc.mie.cdf", 0.67);
  EXPECT_NEAR(table.moments[0][1], 0.42, 1e-7);
  ASSERT_EQ(table.notes.size(), 1u);
  EXPECT_THAT(table.notes[0], AllOf(HasSubstr("without the factor 2l+1"), HasSubstr("GUESSED")));
}

// None is above 1, but 1 + 2.85 mu + ... were negative: 1 + .95 mu + ... is meant.
TEST_F(DropletTableFile, TellsMomentsWithTheFactorByTheSign) {
  LibradtranFile content;
  content.pmom_units = "-";
  for (std::size_t n = 0; n < 4; ++n) {
    const std::vector<double> moments{1, 0.95, 0.04, 0.005};
    std::copy(moments.begin(), moments.end(), content.pmom.begin() + static_cast<std::ptrdiff_t>(8 * n));
  }
  content.write(folder_ / "wc.mie.cdf");
  const DropletTable table = read_droplet_table(folder_ / "wc.mie.cdf", 0.67);
  EXPECT_NEAR(table.moments[0][1], 0.95 / 3, 1e-7);
  EXPECT_THAT(table.notes, testing::IsEmpty());
  content.pmom[17] = 0.8;  // negative either way
  content.pmom[18] = -1;
  content.write(folder_ / "wc.mie.cdf");
  EXPECT_THAT(message(folder_ / "wc.mie.cdf", 0.67), AllOf(HasSubstr("radius 5 um"), HasSubstr("negative")));
}

TEST_F(DropletTableFile, AsymmetryParametersTellTheFactor) {
  LibradtranFile content;
  content.pmom_units = "-";
  content.gg = {0.4, 0.35, 0.425, 0.45};
  content.write(folder_ / "wc.mie.cdf");
  EXPECT_NEAR(read_droplet_table(folder_ / "wc.mie.cdf", 0.67).moments[0][1], 0.425, 1e-7);
  content.gg[2] = 0.85;
  content.write(folder_ / "wc.mie.cdf");
  EXPECT_THAT(message(folder_ / "wc.mie.cdf", 0.67), AllOf(HasSubstr("contradict"), HasSubstr("0.425")));
}

// Aerosol: between two humidities extinction and scattering are linear, and moments are mixed by scattering.
TEST_F(DropletTableFile, HumidityChoosesTheRowOfAnAerosol) {
  LibradtranFile content;
  content.axis = "hum";
  content.reff = {50, 80};
  const auto file = folder_ / "waso.mie.cdf";
  content.write(file);
  const DropletTable dry = read_droplet_table(file, 0.67, 50), between = read_droplet_table(file, 0.67, 60);
  ASSERT_EQ(between.size(), 1u);
  EXPECT_NEAR(dry.extinction_m2_per_g[0], 0.301, 1e-15);
  EXPECT_NEAR(dry.moments[0][1], 1.275 / 3, 1e-7);
  EXPECT_NEAR(read_droplet_table(file, 0.67, 80).extinction_m2_per_g[0], 0.151, 1e-15);
  const double lower = 0.301 * 2 / 3, upper = 0.151 / 3;
  const double scattered = lower * 0.99 + upper * 0.98;
  EXPECT_NEAR(between.extinction_m2_per_g[0], lower + upper, 1e-15);
  EXPECT_NEAR(between.single_scattering_albedo[0], scattered / (lower + upper), 1e-15);
  EXPECT_NEAR(between.moments[0][1], (lower * 0.99 * 1.275 + upper * 0.98 * 1.35) / scattered / 3, 1e-7);
  EXPECT_THAT(message(file, 0.67), HasSubstr("relative_humidity_percent"));
  const auto refused = [](const std::filesystem::path& of, double percent) {
    try {
      read_droplet_table(of, 0.67, percent);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refused(file, 90), HasSubstr("found 90 %, allowed 50 to 80 %"));
  content.axis = "reff";
  content.reff = {5, 10};
  content.write(file);
  EXPECT_THAT(refused(file, 60), HasSubstr("a table by effective radius"));
}

// Moments g^l. Their sum (2l+1) g^l is the forward peak (1 + g)/(1 - g)^2.
TEST_F(DropletTableFile, AsymmetryParametersAloneAreHenyeyGreensteins) {
  LibradtranFile content;
  content.without = "pmom";
  content.gg = {0.4, 0.35, 0.85, -0.5};
  content.write(folder_ / "wc.mie.cdf");
  const DropletTable table = read_droplet_table(folder_ / "wc.mie.cdf", 0.67);
  ASSERT_EQ(table.moments.size(), 2u);
  for (std::size_t n = 0; n < 2; ++n) {
    const double g = content.gg[2 + n];
    double peak = 0;
    for (std::size_t l = 0; l < table.moments[n].size(); ++l)
      peak += static_cast<double>(2 * l + 1) * table.moments[n][l];
    EXPECT_NEAR(peak, (1 + g) / ((1 - g) * (1 - g)), 1e-5);
    EXPECT_NEAR(table.moments[n][2], g * g, 1e-15);
  }
  ASSERT_EQ(table.notes.size(), 1u);
  EXPECT_THAT(table.notes[0], HasSubstr("Henyey-Greenstein"));
  content.gg[2] = 1;
  content.write(folder_ / "wc.mie.cdf");
  EXPECT_THAT(message(folder_ / "wc.mie.cdf", 0.67), HasSubstr("asymmetry parameter (found 1, allowed up to 0.995)"));
}

TEST_F(DropletTableFile, KnowsTheUnitHoweverItIsSpelled) {
  LibradtranFile content;
  for (const char* units : {"km^-1/(g/m^3)", "km-1/(g/m3)", "1/km/(g/m3)", "km^{-1} / (g m^{-3})"}) {
    content.ext_units = units;
    content.write(folder_ / "wc.mie.cdf");
    EXPECT_NEAR(read_droplet_table(folder_ / "wc.mie.cdf", 0.67).extinction_m2_per_g[1], 0.151, 1e-15) << units;
  }
}

constexpr const char* shdom =
    "! Mie scattering table vs. effective radius (LWC=1 g/m^3)\n"
    "    0.660    0.680  wavelength range (micron)\n"
    "  1.000  W   particle density (g/cm^3) and type (Water, Ice, Aerosol)\n"
    "  1.331000E+00 -2.000000E-08  particle index of refraction\n"
    "  7.00000 gamma size distribution shape parameter\n"
    "   2    5.000   10.000  number, starting, ending effective radius\n"
    "   5.0000  3.01000E+02 0.990000      4   Reff  Ext  Alb  Nleg\n"
    "     1.00000   1.27500   0.60000   0.06000\n"
    "     0.04500\n"
    "  10.0000  1.51000D+02 0.980000      3   Reff  Ext  Alb  Nleg\n"
    "     1.00000   1.35000   0.70000   0.06300\n";

TEST_F(DropletTableFile, ReadsShdom) {
  const DropletTable table = read_droplet_table(write_text(shdom));
  EXPECT_DOUBLE_EQ(table.wavelength_um, 0.67);
  EXPECT_EQ(table.effective_radius_um, (std::vector<double>{5, 10}));
  EXPECT_DOUBLE_EQ(table.extinction_m2_per_g[0], 0.301);  // 301 1/km for 1 g/m3
  EXPECT_DOUBLE_EQ(table.extinction_m2_per_g[1], 0.151);  // Fortran's D exponent
  EXPECT_DOUBLE_EQ(table.single_scattering_albedo[1], 0.98);
  ASSERT_EQ(table.moments[0].size(), 5u);
  EXPECT_DOUBLE_EQ(table.moments[0][1], 0.425);
  EXPECT_DOUBLE_EQ(table.moments[0][4], 0.005);
  EXPECT_DOUBLE_EQ(table.moments[1][3], 0.009);
  std::string upper = shdom;  // heads in any case
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  EXPECT_EQ(read_droplet_table(write_text(upper)).moments, table.moments);
}

// Polarised tables: six elements, each one line that begins with its number; the first is the phase function.
TEST_F(DropletTableFile, ReadsShdomPolarised) {
  std::string text =
      "! Polarized Mie scattering table vs. effective radius (LWC=1 g/m^3)\n"
      " 0.672 0.672  wavelength range (micron)\n"
      " 1 10.0 10.0  number, starting, ending effective radius\n"
      " 10.0000 1.5E+02 0.98 3  Reff  Ext  Alb  Nrank\n"
      " 1 1.0 1.35 0.7 0.063\n";
  for (int element = 2; element <= 6; ++element) text += " " + std::to_string(element) + " 0.0 0.1 0.2 0.3\n";
  const DropletTable table = read_droplet_table(write_text(text));
  EXPECT_EQ(table.moments[0].size(), 4u);
  EXPECT_DOUBLE_EQ(table.moments[0][1], 0.45);
}

TEST_F(DropletTableFile, SaysWhatIsWrongWithShdomsForm) {
  const auto message_after = [&](const std::string& from, const std::string& to) {
    std::string text = shdom;
    text.replace(text.find(from), from.size(), to);
    return message(write_text(text));
  };
  EXPECT_THAT(message_after("     0.04500\n", ""), AllOf(HasSubstr("found 4, allowed 5"), HasSubstr("radius 5 um")));
  EXPECT_THAT(message_after("   2    5.000", "   3    5.000"), HasSubstr("incomplete (found 2 effective radii"));
  EXPECT_THAT(message_after("3.01000E+02", "abc"), HasSubstr("line 7"));
  EXPECT_THAT(message_after(" 1.00000   1.35000", " 0.50000   1.35000"), HasSubstr("wrong norm"));
  EXPECT_THAT(message_after("1.35000", "3.70000"), HasSubstr("out of range"));
  EXPECT_THAT(message_after("1.35000", "2.70000"), AllOf(HasSubstr("radius 10 um"), HasSubstr("negative")));
  EXPECT_THAT(message_after("10.0000", " 4.0000"), HasSubstr("do not ascend"));
  EXPECT_THAT(message_after("0.06300", "3.14000"), HasSubstr("too few moments"));
}

}  // namespace
}  // namespace cloudbow
