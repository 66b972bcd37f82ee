// Droplet tables in libRadtran's form. Truth: moments in closed form that the files are made of.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/droplet_table_file.hpp"
#include "droplet_file_tools.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

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
  double count = 4;  // of moments, as nmom says
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
    const int v_nmom = define("nmom", {lambda, radius, element}, std::isnan(count) ? NC_DOUBLE : NC_INT);
    const int v_gg = gg.empty() ? -1 : define("gg", {lambda, radius}, NC_DOUBLE);
    const int v_pmom = define("pmom", {lambda, radius, element, moment}, NC_FLOAT);
    if (v_ext >= 0) nc_put_att_text(id, v_ext, "units", std::string(ext_units).size(), ext_units);
    if (v_pmom >= 0) nc_put_att_text(id, v_pmom, "units", std::string(pmom_units).size(), pmom_units);
    nc_enddef(id);
    const std::vector<double> wavelength{0.55, 0.67};
    const std::vector<double> nmom(8, count);
    nc_put_var_double(id, v_lambda, wavelength.data());
    nc_put_var_double(id, v_radius, reff.data());
    if (v_ext >= 0) nc_put_var_double(id, v_ext, ext.data());
    nc_put_var_double(id, v_ssa, ssa.data());
    nc_put_var_double(id, v_nmom, nmom.data());
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

std::string refused_at(const std::filesystem::path& file, double humidity_percent) {
  try {
    read_droplet_table(file, 0.67, humidity_percent);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
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
  EXPECT_THAT(refused_at(file, 90), HasSubstr("found 90 %, allowed 50 to 80 %"));
  content.axis = "reff";
  content.reff = {5, 10};
  content.write(file);
  EXPECT_THAT(refused_at(file, 60), HasSubstr("a table by effective radius"));
}

// At 60 % each of these rows would be mixed to values within their range.
TEST_F(DropletTableFile, RowsOfHumiditiesAreCheckedBeforeTheyAreMixed) {
  const auto file = folder_ / "waso.mie.cdf";
  const auto refused = [&](const std::function<void(LibradtranFile&)>& change) {
    LibradtranFile content;
    content.axis = "hum";
    content.reff = {50, 80};
    change(content);
    content.write(file);
    return refused_at(file, 60);
  };
  EXPECT_EQ(refused([](LibradtranFile&) {}), "");
  EXPECT_THAT(refused([](LibradtranFile& f) {
                f.ssa = {1, 1, 0.3, 1.2};
              }),
              HasSubstr("albedo at relative humidity 80 % out of range (found 1.2"));
  EXPECT_THAT(refused([](LibradtranFile& f) { f.ext[3] = -10; }), HasSubstr("extinction at relative humidity 80 %"));
  EXPECT_THAT(refused([](LibradtranFile& f) { f.pmom[16] = 1.2, f.pmom[24] = 0.1945; }),
              HasSubstr("phase function at relative humidity 50 %: wrong norm"));
  EXPECT_THAT(refused([](LibradtranFile& f) { f.reff = {-50, 80}; }), HasSubstr("'hum': out of range (found -50 %"));
  EXPECT_THAT(refused([](LibradtranFile& f) { f.reff = {std::nan(""), 80}; }), HasSubstr("'hum': out of range"));
  EXPECT_THAT(refused([](LibradtranFile& f) {
                f.reff = {80, 50};
              }),
              HasSubstr("does not ascend (found 50 % after 80 %"));
}

TEST_F(DropletTableFile, ANumberOfMomentsIsANumber) {
  for (const double count : {std::nan(""), -1.}) {
    LibradtranFile content;
    content.count = count;
    content.write(folder_ / "wc.mie.cdf");
    EXPECT_THAT(message(folder_ / "wc.mie.cdf", 0.67), HasSubstr("'nmom': number of moments out of range"));
  }
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

}  // namespace
}  // namespace cloudbow
