// Maps of albedo as PNG. Truth: the levels of the pixels.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <utility>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/albedo_map.hpp"
#include "map_test_tools.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::FloatEq;
using testing::HasSubstr;
using testing::Pointwise;

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

}  // namespace
}  // namespace cloudbow
