// Functions that the tests of maps of the ground share.
#pragma once

#include <gmock/gmock.h>
#include <netcdf.h>
#include <png.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "cloud_test_tools.hpp"
#include "cloudbow/medium/albedo_map.hpp"

namespace cloudbow {

class AlbedoMapFile : public testing::Test {
 protected:
  AlbedoMapFile() { std::filesystem::create_directories(folder_); }
  ~AlbedoMapFile() override { std::filesystem::remove_all(folder_); }

  static std::string message(const std::filesystem::path& file) {
    try {
      read_albedo_map(file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  static void expect_values(const std::filesystem::path& file, const std::vector<float>& expected) {
    ASSERT_EQ(message(file), "no error");
    EXPECT_THAT(read_albedo_map(file).value,
                testing::Pointwise(testing::FloatNear(1e-7F), expected));  // packed numbers are rounded
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("cloudbow_albedo_" + std::to_string(::getpid()));
};

/// Lines from the top, as bytes of the file.
struct Picture {
  png_uint_32 width = 3;
  int depth = 8;
  int colour = PNG_COLOR_TYPE_GRAY;
  std::vector<std::vector<std::uint8_t>> line;
  int interlace = PNG_INTERLACE_NONE;
  std::function<void(png_structp, png_infop)> more{};  ///< further chunks

  std::filesystem::path write(const std::filesystem::path& file) const {
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

  std::filesystem::path write(const std::filesystem::path& file) const {
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

inline const std::vector<float> ascending{0, .1F, .2F, .3F, .4F, .5F};
inline const std::vector<float> rows_turned{.3F, .4F, .5F, 0, .1F, .2F};

}  // namespace cloudbow
