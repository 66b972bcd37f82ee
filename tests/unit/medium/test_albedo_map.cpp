// Maps of albedo. Truth: the numbers that each file here is written with.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>
#include <netcdf.h>
#include <png.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/albedo_map.hpp"

namespace cloudbow {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::FloatEq;
using testing::HasSubstr;
using testing::Pointwise;

class AlbedoMapFile : public testing::Test {
 protected:
  AlbedoMapFile() { fs::create_directories(folder_); }
  ~AlbedoMapFile() override { fs::remove_all(folder_); }

  static std::string message(const fs::path& file) {
    try {
      read_albedo_map(file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  static void expect_values(const fs::path& file, const std::vector<float>& expected) {
    ASSERT_EQ(message(file), "no error");
    EXPECT_THAT(read_albedo_map(file).value,
                Pointwise(testing::FloatNear(1e-7F), expected));  // packed numbers are rounded
  }

  const fs::path folder_ = fs::temp_directory_path() / ("cloudbow_albedo_" + std::to_string(::getpid()));
};

// -- PNG --------------------------------------------------------------------------------------------------------------

/// Lines from the top, as bytes of the file.
struct Picture {
  png_uint_32 width = 3;
  int depth = 8;
  int colour = PNG_COLOR_TYPE_GRAY;
  std::vector<std::vector<std::uint8_t>> line;
  int interlace = PNG_INTERLACE_NONE;
  std::function<void(png_structp, png_infop)> more{};  ///< further chunks

  fs::path write(const fs::path& file) const {
    std::FILE* stream = std::fopen(file.c_str(), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, stream);
    png_set_IHDR(png, info, width, static_cast<png_uint_32>(line.size()), depth, colour, interlace,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (more) more(png, info);
    png_write_info(png, info);
    std::vector<png_bytep> row;
    for (const auto& bytes : line) row.push_back(const_cast<png_bytep>(bytes.data()));
    png_write_image(png, row.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    std::fclose(stream);
    return file;
  }
};

TEST_F(AlbedoMapFile, ReadsGreyOfAPngFromTheLowestLineUp) {
  const Picture picture{.line = {{0, 51, 255}, {102, 153, 204}}};
  const GroundMap map = read_albedo_map(picture.write(folder_ / "map.png"));
  EXPECT_EQ(map.nx, 3);
  EXPECT_EQ(map.ny, 2);
  EXPECT_THAT(map.value, Pointwise(FloatEq(), {.4F, .6F, .8F, 0.F, .2F, 1.F}));
  EXPECT_FALSE(map.length_m[0] || map.length_m[1]);
}

// A map is data: gamma, which says how levels are to look, changes none.
TEST_F(AlbedoMapFile, ReadsLevelsOfAPngAsTheyAre) {
  const std::vector<std::vector<std::uint8_t>> wide{{0x80, 0x83, 0x40, 0x00, 0xff, 0xff}};  // 32899, 16384, 65535
  const std::vector<float> expected{32899 / 65535.F, 16384 / 65535.F, 1.F};
  expect_values(Picture{.depth = 16, .line = wide}.write(folder_ / "16.png"), expected);
  for (const double gamma : {1.0, 0.45455}) {
    const auto chunk = [gamma](png_structp png, png_infop info) { png_set_gAMA(png, info, gamma); };
    expect_values(Picture{.depth = 16, .line = wide, .more = chunk}.write(folder_ / "16.png"), expected);
    expect_values(Picture{.line = {{128, 64, 255}}, .more = chunk}.write(folder_ / "8.png"),
                  {128 / 255.F, 64 / 255.F, 1});
  }
  const auto srgb = [](png_structp png, png_infop info) { png_set_sRGB(png, info, PNG_sRGB_INTENT_ABSOLUTE); };
  expect_values(Picture{.depth = 16, .line = wide, .more = srgb}.write(folder_ / "16.png"), expected);
  expect_values(Picture{.depth = 1, .line = {{0xa0}}}.write(folder_ / "1.png"), {1, 0, 1});
  expect_values(Picture{.depth = 2, .line = {{0x6c}}}.write(folder_ / "2.png"), {1 / 3.F, 2 / 3.F, 1});
  expect_values(Picture{.depth = 4, .line = {{0x3f, 0x60}}}.write(folder_ / "4.png"), {.2F, 1, .4F});
}

TEST_F(AlbedoMapFile, ReadsAnInterlacedPng) {
  std::vector<std::vector<std::uint8_t>> line(9, std::vector<std::uint8_t>(10));
  std::vector<float> expected;
  for (std::size_t j = 9; j-- > 0;) {
    for (std::size_t i = 0; i < 10; ++i) {
      line[j][i] = static_cast<std::uint8_t>(20 * j + i);
      expected.push_back(static_cast<float>(line[j][i]) / 255);
    }
  }
  expect_values(Picture{.width = 10, .line = line, .interlace = PNG_INTERLACE_ADAM7}.write(folder_ / "map.png"),
                expected);
}

TEST_F(AlbedoMapFile, ReadsGreyPixelsOfColourAndPalettesAlone) {
  const auto colours = [&](std::vector<std::uint8_t> bytes) {
    return Picture{.width = 2, .colour = PNG_COLOR_TYPE_RGB, .line = {std::move(bytes)}}.write(folder_ / "map.png");
  };
  expect_values(colours({51, 51, 51, 204, 204, 204}), {.2F, .8F});
  EXPECT_THAT(message(colours({51, 51, 51, 204, 204, 203})),
              AllOf(HasSubstr("map.png"), HasSubstr("red 204, green 204, blue 203"), HasSubstr("grey levels")));
  const auto palette = [&](png_color second) {
    const auto chunk = [second](png_structp png, png_infop info) {
      const png_color entries[] = {{51, 51, 51}, second};
      png_set_PLTE(png, info, entries, 2);
    };
    const std::vector<std::vector<std::uint8_t>> line{{0x40}};
    return Picture{.width = 2, .depth = 1, .colour = PNG_COLOR_TYPE_PALETTE, .line = line, .more = chunk}.write(
        folder_ / "map.png");
  };
  expect_values(palette({204, 204, 204}), {.2F, .8F});
  EXPECT_THAT(message(palette({204, 0, 0})), HasSubstr("a picture in colour"));
}

TEST_F(AlbedoMapFile, RefusesTransparentPixels) {
  const auto with_alpha = [&](std::uint8_t alpha) {
    const std::vector<std::vector<std::uint8_t>> line{{51, 255, 204, alpha}};
    return Picture{.width = 2, .colour = PNG_COLOR_TYPE_GRAY_ALPHA, .line = line}.write(folder_ / "map.png");
  };
  expect_values(with_alpha(255), {.2F, .8F});
  EXPECT_THAT(message(with_alpha(254)), AllOf(HasSubstr("transparent"), HasSubstr("alpha 254"), HasSubstr("column 1")));
  const auto no_colour = [](png_structp png, png_infop info) {
    const png_color_16 grey{.index = 0, .red = 0, .green = 0, .blue = 0, .gray = 204};
    png_set_tRNS(png, info, nullptr, 0, &grey);
  };
  EXPECT_THAT(message(Picture{.line = {{51, 204, 0}}, .more = no_colour}.write(folder_ / "map.png")),
              HasSubstr("transparent"));
}

// -- netCDF -----------------------------------------------------------------------------------------------------------

struct Dimension {
  std::string name;
  std::vector<double> coordinate{};  ///< empty: none
  std::string units{};
};

/// albedo(dimensions) with values 0, 1, 2, ... in the order of the file, times a tenth if not packed.
struct NetcdfFile {
  std::vector<std::pair<Dimension, std::size_t>> dimension = {{{"y"}, 2}, {{"x"}, 3}};
  int format = NC_CLOBBER | NC_NETCDF4;
  nc_type type = NC_FLOAT;
  double first = 0;
  double step = .1;
  std::vector<std::pair<std::string, std::vector<double>>> numbers{};  ///< attributes, in the variable's type or float
  std::string units{};
  std::string name = "albedo";

  fs::path write(const fs::path& file) const {
    int id = 0, variable = 0;
    nc_create(file.c_str(), format, &id);
    std::vector<int> dimensions, coordinates;
    std::size_t size = 1;
    for (const auto& [axis, length] : dimension) {
      nc_def_dim(id, axis.name.c_str(), length, &dimensions.emplace_back());
      size *= length;
      if (axis.coordinate.empty()) continue;
      nc_def_var(id, axis.name.c_str(), NC_FLOAT, 1, &dimensions.back(), &coordinates.emplace_back());
      nc_put_att_text(id, coordinates.back(), "units", axis.units.size(), axis.units.c_str());
    }
    nc_def_var(id, name.c_str(), type, static_cast<int>(dimensions.size()), dimensions.data(), &variable);
    for (const auto& [attribute, value] : numbers) {
      const bool packed = attribute != "scale_factor" && attribute != "add_offset";
      nc_put_att_double(id, variable, attribute.c_str(), packed ? type : NC_DOUBLE, value.size(), value.data());
    }
    if (!units.empty()) nc_put_att_text(id, variable, "units", units.size(), units.c_str());
    nc_enddef(id);
    std::vector<double> value(size);
    for (std::size_t n = 0; n < size; ++n) value[n] = first + step * static_cast<double>(n);
    nc_put_var_double(id, variable, value.data());
    std::size_t next = 0;
    for (const auto& [axis, length] : dimension) {
      if (!axis.coordinate.empty()) nc_put_var_double(id, coordinates[next++], axis.coordinate.data());
    }
    nc_close(id);
    return file;
  }
};

const std::vector<float> ascending{0, .1F, .2F, .3F, .4F, .5F};
const std::vector<float> rows_turned{.3F, .4F, .5F, 0, .1F, .2F};

TEST_F(AlbedoMapFile, ReadsNetcdfOfAllForms) {
  for (const int form : {0, NC_64BIT_OFFSET, NC_64BIT_DATA, NC_NETCDF4, NC_NETCDF4 | NC_CLASSIC_MODEL}) {
    NetcdfFile content;
    content.format = NC_CLOBBER | form;
    expect_values(content.write(folder_ / "map.nc"), ascending);
    content.dimension[0].first = {"lat", {51, 50}, "degrees_north"};
    expect_values(content.write(folder_ / "map.nc"), rows_turned);
  }
}

TEST_F(AlbedoMapFile, CoordinatesAndNamesSayWhichWayItLies) {
  NetcdfFile content;
  content.dimension = {{{"y", {0, 100}, "m"}, 2}, {{"x", {.2, .1, 0}, "km"}, 3}};
  expect_values(content.write(folder_ / "map.nc"), {.2F, .1F, 0, .5F, .4F, .3F});
  const GroundMap map = read_albedo_map(folder_ / "map.nc");
  EXPECT_NEAR(*map.length_m[0], 300, 1e-4);  // coordinates in floats
  EXPECT_EQ(*map.length_m[1], 200);
  content.dimension = {{{"lon"}, 2}, {{"lat", {3, 2, 1}, "degrees_north"}, 3}};
  expect_values(content.write(folder_ / "map.nc"), {.2F, .5F, .1F, .4F, 0, .3F});  // transposed, and turned
  EXPECT_FALSE(read_albedo_map(folder_ / "map.nc").length_m[1]);
  content.dimension = {{{"row"}, 2}, {{"column"}, 3}};
  expect_values(content.write(folder_ / "map.nc"), ascending);
  content.dimension = {{{"y"}, 2}, {{"x", {0, 1, 5}, "m"}, 3}};
  EXPECT_THAT(message(content.write(folder_ / "map.nc")), AllOf(HasSubstr("'x': uneven"), HasSubstr("interpolate")));
  content.dimension = {{{"y"}, 2}, {{"x", {358, 359, 0}, "degrees_east"}, 3}};
  EXPECT_THAT(message(content.write(folder_ / "map.nc")), HasSubstr("'x': uneven"));
  content.dimension = {{{"y"}, 2}, {{"x", {7, 7, 7}, "m"}, 3}};
  EXPECT_THAT(message(content.write(folder_ / "map.nc")), HasSubstr("'x': uneven"));
}

TEST_F(AlbedoMapFile, DimensionsOfLengthOneAreLeftOut) {
  NetcdfFile content;
  content.dimension = {{{"time", {7}, "days"}, 1}, {{"band"}, 1}, {{"y"}, 2}, {{"x"}, 3}};
  expect_values(content.write(folder_ / "map.nc"), ascending);
  content.dimension = {{{"y"}, 2}, {{"x"}, 3}, {{"band"}, 1}};
  expect_values(content.write(folder_ / "map.nc"), ascending);
  content.dimension = {{{"y"}, 1}, {{"x"}, 6}};
  expect_values(content.write(folder_ / "map.nc"), ascending);
  content.dimension = {{{"time"}, 2}, {{"y"}, 1}, {{"x"}, 3}};
  EXPECT_THAT(message(content.write(folder_ / "map.nc")), AllOf(HasSubstr("time = 2"), HasSubstr("length 1")));
  content.dimension = {{{"time"}, 2}, {{"x"}, 3}};
  EXPECT_THAT(message(content.write(folder_ / "map.nc")), HasSubstr("allowed y, x"));
}

TEST_F(AlbedoMapFile, ObeysPackingAndUnits) {
  NetcdfFile content;
  content.type = NC_SHORT;
  content.first = 300;
  content.step = 100;
  content.numbers = {{"scale_factor", {.001}}, {"add_offset", {-.3}}, {"_FillValue", {32767}}};
  expect_values(content.write(folder_ / "map.nc"), ascending);
  content = {};
  content.step = 10;
  content.units = "%";
  expect_values(content.write(folder_ / "map.nc"), ascending);
  content.units = "Percent";
  expect_values(content.write(folder_ / "map.nc"), ascending);
  content.units = "W m-2";
  EXPECT_THAT(message(content.write(folder_ / "map.nc")), AllOf(HasSubstr("W m-2"), HasSubstr("1, %")));
  content.units = "1";
  EXPECT_THAT(message(content.write(folder_ / "map.nc")),
              AllOf(HasSubstr("found 10 at row 0, column 1"), HasSubstr("units")));
  content = {};
  content.first = -.1;
  EXPECT_THAT(message(content.write(folder_ / "map.nc")), HasSubstr("found -0.1 at row 0, column 0"));
}

TEST_F(AlbedoMapFile, TemperaturesAreInKelvin) {
  const auto message_of = [&](const fs::path& file) -> std::string {
    try {
      read_temperature_map(file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  NetcdfFile content;
  content.name = "surface_temperature";
  content.first = 280;
  content.step = 2;
  content.units = "K";
  EXPECT_THAT(read_temperature_map(content.write(folder_ / "map.nc")).value,
              Pointwise(FloatEq(), {280.F, 282.F, 284.F, 286.F, 288.F, 290.F}));
  content.units = "degC";
  EXPECT_THAT(message_of(content.write(folder_ / "map.nc")), AllOf(HasSubstr("found 'degC'"), HasSubstr("allowed K")));
  content.units = "";
  content.first = 10;
  EXPECT_THAT(message_of(content.write(folder_ / "map.nc")),
              AllOf(HasSubstr("found 10 at row 0, column 0"), HasSubstr("100 to 1000 K, not Celsius")));
  EXPECT_THAT(message_of(Picture{.line = {{0, 51, 255}}}.write(folder_ / "map.png")), HasSubstr("found PNG"));
}

TEST_F(AlbedoMapFile, RefusesMissingValues) {
  for (const auto& [attribute, value] :
       std::vector<std::pair<std::string, std::vector<double>>>{{"_FillValue", {5}},
                                                                {"missing_value", {5}},
                                                                {"valid_range", {0, 4}},
                                                                {"valid_max", {4}},
                                                                {"valid_min", {1}}}) {
    NetcdfFile content;
    content.type = NC_SHORT;
    content.step = 1;
    content.numbers = {{"scale_factor", {.1}}, {attribute, value}};
    const std::string place = attribute == "valid_min" ? "row 0, column 0" : "row 1, column 2";
    EXPECT_THAT(message(content.write(folder_ / "map.nc")),
                AllOf(HasSubstr("no value at " + place), HasSubstr("fill the gaps")))
        << attribute;
  }
}

// Made in HDF5, the size of 1e8 x 1 takes no place on the disk.
TEST_F(AlbedoMapFile, RefusesMoreValuesThanAnyDomainNeeds) {
  const hid_t file = H5Fcreate((folder_ / "map.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t shape[] = {100000000, 1};
  const hid_t space = H5Screate_simple(2, shape, nullptr);
  H5Dclose(H5Dcreate2(file, "albedo", H5T_NATIVE_FLOAT, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Sclose(space);
  H5Fclose(file);
  EXPECT_THAT(message(folder_ / "map.h5"), AllOf(HasSubstr("1 x 100000000"), HasSubstr("2.5e+07")));
}

// -- HDF5 and what is none --------------------------------------------------------------------------------------------

class AlbedoMapInHdf5 : public AlbedoMapFile {
 protected:
  // Datasets of 2 rows and 3 columns: 0, 1, ... 5 times `scale`.
  fs::path hdf5(const std::vector<std::pair<std::string, float>>& datasets) {
    const fs::path file = folder_ / "map.h5";
    const hid_t id = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hsize_t shape[] = {2, 3};
    for (const auto& [name, scale] : datasets) {
      std::vector<float> value(6);
      for (int i = 0; i < 6; ++i) value[i] = scale * static_cast<float>(i);
      H5LTmake_dataset_float(id, name.c_str(), 2, shape, value.data());
    }
    const hsize_t length[] = {4};
    const float line[] = {1, 2, 3, 4};
    H5LTmake_dataset_float(id, "axis", 1, length, line);
    H5Fclose(id);
    return file;
  }
};

TEST_F(AlbedoMapInHdf5, ReadsTheNamedDatasetOrTheOnlyOne) {
  expect_values(hdf5({{"other", 2}, {"albedo", .1F}}), ascending);
  expect_values(hdf5({{"other", .1F}}), ascending);
}

TEST_F(AlbedoMapInHdf5, SaysWhatIsWrong) {
  EXPECT_THAT(message(folder_ / "none.h5"), AllOf(HasSubstr("none.h5"), HasSubstr("no such file")));
  EXPECT_THAT(message(folder_), HasSubstr("found a directory"));
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(message(folder_ / "pipe"), HasSubstr("found a named pipe"));
  EXPECT_THAT(message(hdf5({{"one", .1F}, {"two", .1F}})),
              AllOf(HasSubstr("albedo"), HasSubstr("axis("), HasSubstr("one("), HasSubstr("two(")));
  std::ofstream(folder_ / "words.h5") << "not a map";
  EXPECT_THAT(message(folder_ / "words.h5"), HasSubstr("neither PNG nor HDF5"));
  std::ofstream(folder_ / "cut.png", std::ios::binary) << "\x89PNG\r\n\x1a\n and nothing more";
  EXPECT_THAT(message(folder_ / "cut.png"), HasSubstr("cut.png"));
  const fs::path whole =
      Picture{.width = 64, .line = {64, std::vector<std::uint8_t>(64, 7)}}.write(folder_ / "map.png");
  fs::resize_file(whole, fs::file_size(whole) - 20);
  EXPECT_THAT(message(whole), HasSubstr("not a PNG that can be read"));
}

TEST(CheckCovers, MapsWithCoordinatesHaveTheSizeOfTheDomain) {
  GroundMap map{200, 2, std::vector<float>(400, .5F), {}};
  EXPECT_NO_THROW(check_covers(map, "m.nc", {1, 1}));  // no coordinates: any size
  map.length_m = {1000, 500};
  EXPECT_NO_THROW(check_covers(map, "m.nc", {1009, 740}));  // along y a cell is half of the map
  EXPECT_NO_THROW(check_covers(map, "m.nc", {991, 500}));
  const auto told = [&map](double x, double y) {
    try {
      check_covers(map, "m.nc", {x, y});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(told(1012, 500), HasSubstr("m.nc: not the size of the domain (found 1000 m along x by its coordinates, "
                                         "allowed 1012 m"));
  EXPECT_THAT(told(1000, 1010), HasSubstr("found 500 m along y"));
}

TEST(AreaMeans, KeepTheMeanAndTheValuesOfEqualCells) {
  const GroundMap map{3, 2, {0, 1, 2, 3, 4, 5}, {}};
  EXPECT_EQ(area_means(map, 3, 2), map.value);
  EXPECT_EQ(area_means(map, 1, 1), (std::vector<float>{2.5F}));
  EXPECT_EQ(area_means(map, 6, 1), (std::vector<float>{1.5F, 1.5F, 2.5F, 2.5F, 3.5F, 3.5F}));
  const std::vector<float> uneven = area_means(map, 2, 2);  // the middle column is shared: (0 + 1/2)/1.5, ...
  EXPECT_FLOAT_EQ(uneven[0], 1.F / 3);
  EXPECT_FLOAT_EQ(uneven[1], 5.F / 3);
  for (const auto& [nx, ny] : {std::pair{7, 5}, std::pair{2, 3}, std::pair{10, 1}}) {
    const std::vector<float> means = area_means(map, nx, ny);
    EXPECT_NEAR(std::accumulate(means.begin(), means.end(), 0.) / (nx * ny), 2.5, 1e-6);
  }
}

// When each row was widened to the columns and kept, this took 2.4 GB.
TEST(AreaMeans, OfALongStripTakeNoMoreMemoryThanItsColumns) {
  const GroundMap strip{1, 100000, std::vector<float>(100000, .5F), {}};
  EXPECT_THAT(area_means(strip, 3000, 2), testing::Each(FloatEq(.5F)));
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  EXPECT_LT(usage.ru_maxrss, 1 << 20);  // b
}

}  // namespace
}  // namespace cloudbow
