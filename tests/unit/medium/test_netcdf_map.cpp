// Maps as netCDF. Truth: the numbers of the files, by netCDF's conventions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <netcdf.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/albedo_map.hpp"
#include "map_test_tools.hpp"

namespace cloudbow {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::FloatEq;
using testing::HasSubstr;
using testing::Pointwise;

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

}  // namespace
}  // namespace cloudbow
