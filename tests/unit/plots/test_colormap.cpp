// Colour maps. Truths: the definition of lightness (CIE 1976), and colours that others have published.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/plots/render.hpp"
#include "plots/colormap.hpp"

namespace cloudbow {
namespace {

/// L* of an sRGB colour under D65 (IEC 61966-2-1 and CIE 1976).
double lightness(const Rgb& colour) {
  const auto linear = [](int byte) {
    const double v = byte / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  const double y = 0.2126729 * linear(colour[0]) + 0.7151522 * linear(colour[1]) + 0.0721750 * linear(colour[2]);
  return y > std::pow(6.0 / 29, 3) ? 116 * std::cbrt(y) - 16 : y * std::pow(29.0 / 3, 3);
}

TEST(Colormap, EqualStepsAreEqualStepsOfLightness) {
  for (const auto& [name, first, last] : {std::tuple("grey", 0.0, 100.0), std::tuple("blue-yellow", 20.0, 92.0)}) {
    const auto colour = make_colormap(name, 255);
    ASSERT_EQ(colour.size(), 255u);
    for (std::size_t i = 0; i < colour.size(); ++i) {
      const double expected = first + (last - first) * static_cast<double>(i) / 254;
      // Bytes: half a step of 1/255 in each channel moves L* by at most 0.3. A clipped channel moves it by more.
      EXPECT_NEAR(lightness(colour[i]), expected, 0.3) << name << ' ' << i;
    }
  }
  const auto colour = make_colormap("blue-yellow", 255);
  EXPECT_GT(colour.front()[2], colour.front()[0]);  // starts blue
  EXPECT_GT(colour.back()[0], colour.back()[2]);    // ends yellow
  EXPECT_GT(colour.back()[1], colour.back()[2]);
}

// The colours at 0, 1/4, 1/2, 3/4 and 1: for viridis as matplotlib and the R package viridisLite show them, for cividis
// as matplotlib does.
TEST(Colormap, PublishedMapsHaveTheirAnchors) {
  using Anchors = std::vector<std::pair<std::size_t, Rgb>>;
  const std::vector<std::pair<std::string, Anchors>> maps{{"viridis",
                                                           {{0, {0x44, 0x01, 0x54}},
                                                            {64, {0x3b, 0x52, 0x8b}},
                                                            {128, {0x21, 0x91, 0x8c}},
                                                            {191, {0x5c, 0xc8, 0x63}},
                                                            {255, {0xfd, 0xe7, 0x25}}}},
                                                          {"cividis",
                                                           {{0, {0x00, 0x22, 0x4e}},
                                                            {64, {0x43, 0x4e, 0x6c}},
                                                            {128, {0x7d, 0x7c, 0x78}},
                                                            {191, {0xbb, 0xad, 0x6d}},
                                                            {255, {0xfe, 0xe8, 0x38}}}}};
  for (const auto& [name, anchors] : maps) {
    const std::vector<Rgb> colour = make_colormap(name, 256);
    ASSERT_EQ(colour.size(), 256U);
    for (const auto& [index, published] : anchors) EXPECT_EQ(colour[index], published) << name << ' ' << index;
  }
}

// Both are made for even steps of lightness, which a mistyped digit would break: a step of 1/255 in green is 0.3 of L*.
TEST(Colormap, PublishedMapsBrightenEvenly) {
  for (const char* name : {"viridis", "cividis"}) {
    const std::vector<Rgb> colour = make_colormap(name, 256);
    const double step = (lightness(colour.back()) - lightness(colour.front())) / 255;
    for (std::size_t i = 0; i + 1 < colour.size(); ++i)
      EXPECT_NEAR(lightness(colour[i + 1]) - lightness(colour[i]), step, 0.7) << name << ' ' << i;
  }
}

// Zero has the middle; what is equally far from it is equally dark. A clipped channel would move L* by more than bytes
// do.
TEST(Colormap, TheDivergingMapIsSymmetricInLightness) {
  const std::vector<Rgb> colour = make_colormap("blue-red", 511);
  for (std::size_t n = 0; n <= 255; ++n) {
    const double expected = 96 - 58 * static_cast<double>(255 - n) / 255;
    EXPECT_NEAR(lightness(colour[n]), expected, 0.3) << n;
    EXPECT_NEAR(lightness(colour[510 - n]), expected, 0.3) << n;
  }
  EXPECT_GT(colour.front()[2], colour.front()[0]);
  EXPECT_GT(colour.back()[0], colour.back()[2]);
  EXPECT_LE(*std::max_element(colour[255].begin(), colour[255].end()) -
                *std::min_element(colour[255].begin(), colour[255].end()),
            2);  // colourless
}

TEST(Colormap, OtherSizesAreInterpolated) {
  for (const char* name : {"viridis", "cividis"}) {
    const std::vector<Rgb> published = make_colormap(name, 256), colour = make_colormap(name, 255);
    EXPECT_EQ(colour.front(), published.front());
    EXPECT_EQ(colour.back(), published.back());
    for (std::size_t i = 0; i < colour.size(); ++i) {
      const double place = static_cast<double>(i) * 255 / 254;
      const auto low = static_cast<std::size_t>(std::min(place, 254.));
      for (std::size_t c = 0; c < 3; ++c) {
        const double share = place - static_cast<double>(low);
        EXPECT_NEAR(colour[i][c], (1 - share) * published[low][c] + share * published[low + 1][c], 0.51);
      }
    }
  }
}

TEST(Colormap, AnotherNameIsRefusedWithThoseThereAre) {
  for (const std::string& name : colormap_names()) EXPECT_EQ(make_colormap(name, 2).size(), 2U);
  EXPECT_EQ(colormap_names(), (std::vector<std::string>{"grey", "blue-yellow", "viridis", "cividis", "blue-red"}));
  EXPECT_THROW(make_colormap("Viridis", 2), InputError);
}

}  // namespace
}  // namespace cloudbow
