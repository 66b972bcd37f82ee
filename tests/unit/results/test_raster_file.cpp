#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>
#include <png.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numeric>

#include "cloudbow/core/error.hpp"
#include "cloudbow/results/raster_file.hpp"

namespace cloudbow {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

class RasterFile : public testing::Test {
 protected:
  RasterFile() { fs::create_directories(folder_); }
  ~RasterFile() override { fs::remove_all(folder_); }

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

  const fs::path folder_ = fs::temp_directory_path() / ("cloudbow_raster_" + std::to_string(::getpid()));
};

TEST_F(RasterFile, ReadsTheNamedDatasetOrTheOnlyOne) {
  const Raster named = read_raster(hdf5({{"other", 2}, {"albedo", .1F}}), "albedo");
  EXPECT_EQ(named.nx, 3);
  EXPECT_EQ(named.ny, 2);
  EXPECT_FLOAT_EQ(named.value[4], .4F);
  EXPECT_FLOAT_EQ(read_raster(hdf5({{"other", 2}}), "albedo").value[4], 8);
}

TEST_F(RasterFile, ReadsGreyOfAPngFromTheLowestLineUp) {
  const fs::path file = folder_ / "map.png";
  const std::uint8_t grey[] = {0, 51, 255, 102, 153, 204};  // upper line, lower line
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = 3;
  image.height = 2;
  image.format = PNG_FORMAT_GRAY;
  ASSERT_NE(png_image_write_to_file(&image, file.c_str(), 0, grey, 0, nullptr), 0);
  const Raster raster = read_raster(file, "albedo");
  EXPECT_FLOAT_EQ(raster.value[0], .4F);
  EXPECT_FLOAT_EQ(raster.value[5], 1);
}

TEST_F(RasterFile, SaysWhatIsWrong) {
  const auto reading = [](const fs::path& file) { return [file] { read_raster(file, "albedo"); }; };
  EXPECT_THAT(reading(folder_ / "none.h5"), ThrowsMessage<InputError>(AllOf(HasSubstr("none.h5"), HasSubstr("read"))));
  EXPECT_THAT(reading(folder_), ThrowsMessage<InputError>(HasSubstr("read")));
  EXPECT_THAT(reading(hdf5({{"one", 1}, {"two", 1}})),
              ThrowsMessage<InputError>(AllOf(HasSubstr("albedo"), HasSubstr("axis, one, two"))));
  std::ofstream(folder_ / "words.h5") << "not a map";
  EXPECT_THAT(reading(folder_ / "words.h5"), ThrowsMessage<InputError>(HasSubstr("neither PNG nor HDF5")));
  std::ofstream(folder_ / "cut.png", std::ios::binary) << "\x89PNG\r\n\x1a\n and nothing more";
  EXPECT_THAT(reading(folder_ / "cut.png"), ThrowsMessage<InputError>(HasSubstr("cut.png")));
}

TEST(AreaMeans, KeepTheMeanAndTheValuesOfEqualCells) {
  const Raster raster{3, 2, {0, 1, 2, 3, 4, 5}};
  EXPECT_EQ(area_means(raster, 3, 2), raster.value);
  EXPECT_EQ(area_means(raster, 1, 1), (std::vector<float>{2.5F}));
  EXPECT_EQ(area_means(raster, 6, 1), (std::vector<float>{1.5F, 1.5F, 2.5F, 2.5F, 3.5F, 3.5F}));
  const std::vector<float> uneven = area_means(raster, 2, 2);  // the middle column is shared: (0 + 1/2)/1.5, ...
  EXPECT_FLOAT_EQ(uneven[0], 1.F / 3);
  EXPECT_FLOAT_EQ(uneven[1], 5.F / 3);
  for (const auto& [nx, ny] : {std::pair{7, 5}, std::pair{2, 3}, std::pair{10, 1}}) {
    const std::vector<float> means = area_means(raster, nx, ny);
    EXPECT_NEAR(std::accumulate(means.begin(), means.end(), 0.) / (nx * ny), 2.5, 1e-6);
  }
}

}  // namespace
}  // namespace cloudbow
