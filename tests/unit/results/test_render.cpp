// Truth: pictures small enough to know every pixel; for the colours the definition of the CIE 1976 lightness, inverted
// here.
#include <gmock/gmock.h>
#include <png.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "cloudbow/core/error.hpp"
#include "cloudbow/results/render.hpp"
#include "colormap.hpp"
#include "sample_solution.hpp"

namespace cloudbow {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;

  int channel(int x, int y, int c) const { return rgba[static_cast<std::size_t>(4 * (y * width + x) + c)]; }
  int red(int x, int y) const { return channel(x, y, 0); }
  int alpha(int x, int y) const { return channel(x, y, 3); }
};

Picture read_png(const fs::path& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_file(&png, file.c_str()), 0) << png.message;
  png.format = PNG_FORMAT_RGBA;
  Picture picture{static_cast<int>(png.width), static_cast<int>(png.height),
                  std::vector<std::uint8_t>(PNG_IMAGE_SIZE(png))};
  EXPECT_NE(png_image_finish_read(&png, nullptr, picture.rgba.data(), 0, nullptr), 0) << png.message;
  return picture;
}

class Render : public testing::Test {
 protected:
  Render() {
    std::string name = (fs::temp_directory_path() / "cloudbow-test-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    options_.result_file = folder_ / "r.h5";
    options_.image_file = folder_ / "r.png";
  }
  ~Render() override { fs::remove_all(folder_); }

  void write(const Solution& solution) { write_result(options_.result_file, solution, sample::info()); }

  Picture draw() {
    report_ = render(options_);
    const Picture picture = read_png(options_.image_file);
    EXPECT_EQ(picture.width, report_.width);
    EXPECT_EQ(picture.height, report_.height);
    return picture;
  }

  fs::path folder_;
  RenderOptions options_;
  RenderReport report_;
};

TEST_F(Render, MapHasXToTheRightAndYUp) {
  Solution solution = sample::solution(3, 2, 1, {0, 1});
  solution.box.dy_m = 25;
  solution.upwelling_flux = {9, 9, 9, 9, 9, 9,  // bottom
                             0, 1, 2, 3, 4, 5};
  write(solution);
  options_.scale = 4;
  const Picture picture = draw();
  ASSERT_EQ(picture.width, 12);
  ASSERT_EQ(picture.height, 8);
  EXPECT_EQ(picture.red(0, 7), 0);     // smallest value, black: x and y lowest, bottom left
  EXPECT_EQ(picture.red(11, 0), 255);  // largest, white: top right
  EXPECT_EQ(picture.red(3, 4), 0);     // the same cell up to its corner
  // Along x values rise by 1, along y by 3.
  EXPECT_GT(picture.red(4, 7), picture.red(3, 7));
  EXPECT_GT(picture.red(0, 3), picture.red(8, 7));
  EXPECT_EQ(report_.min, 0);
  EXPECT_EQ(report_.max, 5);
  EXPECT_EQ(report_.image.place, "z = 530 m");
  EXPECT_EQ(report_.image.units, "W m-2");
}

TEST_F(Render, CellsKeepTheirProportions) {
  write(sample::solution(3, 2, 1));  // cells of 25 x 50 m
  options_.scale = 4;
  const Picture picture = draw();
  EXPECT_EQ(picture.width, 12);
  EXPECT_EQ(picture.height, 16);
}

TEST_F(Render, DefaultSizeIsAbout768) {
  Solution solution = sample::solution(5, 4, 1);
  solution.box.dy_m = 25;
  write(solution);
  const Picture picture = draw();
  EXPECT_EQ(picture.width, 770);  // 5 x 154, the multiple of 5 nearest to 768
  EXPECT_EQ(picture.height, 616);
}

TEST_F(Render, FindsTheNearestLevel) {
  write(sample::solution(2, 2, 3));  // interfaces at 510, 530, 560, 600 m
  options_.level = "bottom";
  draw();
  EXPECT_EQ(report_.min, sample::field_value(1, 0, 0, 0));
  options_.level = "540";
  draw();
  EXPECT_EQ(report_.min, sample::field_value(1, 1, 0, 0));
  EXPECT_EQ(report_.image.place, "z = 530 m");
  options_.variable = "absorbed_power";
  draw();
  EXPECT_EQ(report_.min, sample::field_value(4, 1, 0, 0));
  EXPECT_EQ(report_.image.place, "z = 545 m");
}

TEST_F(Render, RangeClampsAndMissingIsTransparent) {
  Solution solution = sample::solution(4, 1, 1, {1});
  solution.upwelling_flux = {-10, 2, std::nanf(""), 99};
  write(solution);
  options_.scale = 1;
  options_.range = {1, 3};
  const Picture picture = draw();
  EXPECT_EQ(picture.red(0, 0), 0);
  EXPECT_EQ(picture.red(3, 0), 255);
  EXPECT_EQ(picture.alpha(2, 0), 0);
  EXPECT_EQ(picture.alpha(1, 0), 255);
  EXPECT_EQ(picture.red(1, 0), make_colormap("grey", 255)[127][0]);
}

TEST_F(Render, OneRowOfCellsIsDrawnAsSectionWithZUp) {
  Solution solution = sample::solution(4, 1, 2);
  solution.box.z_edge_m = {0, 50, 100};  // 100 m wide, 100 m high
  solution.absorbed_power = {0, 1, 2, 3, 4, 5, 6, 7};
  write(solution);
  options_.variable = "absorbed_power";
  options_.scale = 2;
  const Picture picture = draw();
  ASSERT_EQ(picture.width, 8);
  ASSERT_EQ(picture.height, 8);
  EXPECT_EQ(report_.image.place, "section x-z");
  EXPECT_EQ(picture.red(0, 7), 0);
  EXPECT_EQ(picture.red(7, 0), 255);
  EXPECT_EQ(picture.red(0, 4), 0);
  EXPECT_GT(picture.red(0, 3), picture.red(7, 4));
}

TEST_F(Render, SectionFollowsUnevenLevels) {
  Solution solution = sample::solution(4, 1, 2);
  solution.box.z_edge_m = {0, 25, 100};
  solution.absorbed_power = {0, 0, 0, 0, 1, 1, 1, 1};
  write(solution);
  options_.variable = "absorbed_power";
  options_.scale = 10;
  const Picture picture = draw();
  ASSERT_EQ(picture.height, 40);
  EXPECT_EQ(picture.red(0, 29), 255);
  EXPECT_EQ(picture.red(0, 30), 0);  // the lowest quarter
}

TEST_F(Render, SectionAlongYAndColumnAndUniformValuesAreDrawn) {
  write(sample::solution(1, 4, 2));
  draw();
  EXPECT_EQ(report_.image.place, "section y-z");
  write(sample::solution(1, 1, 6));
  draw();
  EXPECT_EQ(report_.image.place, "column");
  EXPECT_EQ(report_.width, report_.height);
  Solution uniform = sample::solution(2, 2, 1);
  uniform.upwelling_flux.assign(uniform.upwelling_flux.size(), 7);
  write(uniform);
  draw();
  EXPECT_EQ(report_.min, report_.max);
}

TEST_F(Render, ListsWhatIsThere) {
  write(sample::solution(3, 2, 2));
  const auto expect = [this](const RenderOptions& options, const auto& message) {
    EXPECT_THAT([&] { render(options); }, ThrowsMessage<InputError>(message));
    EXPECT_FALSE(fs::exists(options_.image_file));
  };
  RenderOptions wrong = options_;
  wrong.variable = "radiance_nadir";
  expect(wrong, HasSubstr("upwelling_flux, downwelling_diffuse_flux, direct_flux, absorbed_power, actinic_flux"));
  wrong = options_;
  wrong.variable = "z_edge";
  expect(wrong, HasSubstr("no map \"z_edge\""));
  for (const char* level : {"middle", "700", "nan", "", "520m"}) {
    wrong = options_;
    wrong.level = level;
    expect(wrong, HasSubstr("is not top, bottom or a height from 510 to 560 m"));
  }
  wrong = options_;
  wrong.colormap = "jet";
  expect(wrong, HasSubstr("grey, blue-yellow"));
  wrong = options_;
  wrong.range = {3, 3};
  expect(wrong, HasSubstr("range"));
  wrong.range = {0, std::nan("")};
  expect(wrong, HasSubstr("range"));
  wrong = options_;
  wrong.scale = -1;
  expect(wrong, HasSubstr("scale"));
  wrong.scale = 10000;
  expect(wrong, HasSubstr("at most 16384"));
  wrong = options_;
  wrong.image_file = options_.result_file;
  expect(wrong, HasSubstr("is the result file itself"));
  wrong = options_;
  wrong.image_file = folder_ / "missing" / "r.png";
  expect(wrong, HasSubstr("there is no folder"));
}

TEST_F(Render, NamesFilesThatAreNoResults) {
  const auto expect = [this](const fs::path& file, const std::string& reason) {
    options_.result_file = file;
    EXPECT_THAT([&] { render(options_); },
                ThrowsMessage<InputError>(AllOf(HasSubstr(file.string()), HasSubstr(reason))));
  };
  write(sample::solution(30, 30, 10));
  const fs::path whole = options_.result_file;
  expect(folder_ / "missing.h5", "there is no such file");
  expect(folder_, "it is not a file");
  std::ofstream(folder_ / "text.h5") << "not HDF5";
  expect(folder_ / "text.h5", "can't be read as a result file");
  fs::copy(whole, folder_ / "cut.h5");
  fs::resize_file(folder_ / "cut.h5", fs::file_size(whole) / 2);
  expect(folder_ / "cut.h5", "can't be read as a result file");
}

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

}  // namespace
}  // namespace cloudbow
