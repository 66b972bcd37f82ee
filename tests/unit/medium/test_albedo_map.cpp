// Maps of albedo. Truth: the numbers that each file here is written with.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numeric>
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
