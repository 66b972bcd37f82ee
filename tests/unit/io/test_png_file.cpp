// PNG pictures. Truth: the pixels, as libpng reads them.
#include <gtest/gtest.h>
#include <png.h>

#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/png_file.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

/// Red, green, blue and opacity by pixel.
std::vector<std::uint8_t> pixels_of(const std::filesystem::path& file) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_file(&image, file.c_str()), 0) << image.message;
  image.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
  EXPECT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0) << image.message;
  return pixels;
}

TEST(PngFile, ColoursAreThoseOfTheirIndexAndZeroIsTransparent) {
  const TemporaryFolder folder;
  write_png(folder / "a.png", IndexedImage{2, 2, {1, 2, 0, 1}, {{10, 20, 30}, {40, 50, 60}}});
  const std::vector<std::uint8_t> pixels = pixels_of(folder / "a.png");
  ASSERT_EQ(pixels.size(), 16U);
  EXPECT_EQ((std::vector<std::uint8_t>(pixels.begin(), pixels.begin() + 8)),
            (std::vector<std::uint8_t>{10, 20, 30, 255, 40, 50, 60, 255}));
  EXPECT_EQ(pixels[11], 0);
  EXPECT_EQ(pixels[12], 10);
}

TEST(PngFile, RowsOfColourBeginOnTop) {
  const TemporaryFolder folder;
  write_png(folder / "a.png", RgbImage{1, 2, {1, 2, 3, 4, 5, 6}});
  EXPECT_EQ(pixels_of(folder / "a.png"), (std::vector<std::uint8_t>{1, 2, 3, 255, 4, 5, 6, 255}));
}

TEST(PngFile, ThatCannotBeWrittenIsAnInputError) {
  EXPECT_THROW(write_png("/nowhere/a.png", RgbImage{1, 1, {1, 2, 3}}), InputError);
}

}  // namespace
}  // namespace cloudbow
