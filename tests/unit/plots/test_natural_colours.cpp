// Truth: pictures small enough to compute every pixel by hand; the layout of OpenEXR files.
#include <hdf5.h>

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>

#include "cloudbow/core/error.hpp"
#include "render_fixture.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST_F(NaturalColours, CameraStandsUpright) {
  write_spectrum();
  options_.variable = "camera_eye";
  const Picture picture = draw();
  EXPECT_EQ(picture.width, 2);
  EXPECT_EQ(picture.height, 2);
  const auto pixel = [&](int x, int y) {
    return std::array{picture.channel(x, y, 0), picture.channel(x, y, 1), picture.channel(x, y, 2)};
  };
  EXPECT_EQ(pixel(0, 0), (std::array{0, 0, 0}));
  // 1 - 5^-x of 2, 0.5 and 0 is 0.96, 0.5528 and 0; as sRGB bytes by hand: 1.055 v^(1/2.4) - 0.055.
  EXPECT_EQ(pixel(1, 0), (std::array{250, 196, 0}));
  EXPECT_EQ(pixel(0, 1), (std::array{231, 231, 231}));  // a white card: 0.8
  EXPECT_EQ(pixel(1, 1), (std::array{0, 0, 0}));        // nothing there
  EXPECT_THAT(report_.colours, AllOf(HasSubstr("0.67, 0.55, 0.45 um"), HasSubstr("filmic")));
}

TEST_F(NaturalColours, ExposureMultipliesAndLinearClips) {
  write_spectrum();
  options_.variable = "radiance_above";
  options_.tone = "linear";
  options_.exposure = 2;
  options_.scale = 1;
  const Picture picture = draw();
  EXPECT_EQ(picture.width, 1);
  EXPECT_EQ(picture.height, 2);
  EXPECT_EQ(picture.channel(0, 0, 0), 255);  // y up: the second row is on top, clipped
  // 0.25, 0.5 and 1 as sRGB bytes.
  EXPECT_EQ(picture.channel(0, 1, 0), 137);
  EXPECT_EQ(picture.channel(0, 1, 1), 188);
  EXPECT_EQ(picture.channel(0, 1, 2), 255);
}

TEST_F(NaturalColours, OneWavelengthIsGrey) {
  write_spectrum();
  options_.variable = "camera_eye";
  options_.wavelength_um = 0.6;  // nearest: 0.55
  options_.tone = "filmic";
  const Picture picture = draw();
  EXPECT_EQ(picture.red(1, 0), 196);
  EXPECT_EQ(picture.channel(1, 0, 2), 196);
  options_.tone.clear();  // by a colormap, from the least to the largest value
  EXPECT_EQ(draw().red(0, 1), 255);
  EXPECT_EQ(report_.image.wavelength_um, 0.55);
}

TEST_F(NaturalColours, AutomaticExposureMakesTheBrightestWhite) {
  write_spectrum();
  options_.variable = "camera_eye";
  options_.automatic_exposure = true;
  // Luminance 0, 1 and 0.2126 * 2 + 0.7152 * 0.5: the hundredth that may be brighter is none of three.
  draw();
  EXPECT_THAT(report_.colours, HasSubstr("exposure 1.2"));
}

TEST_F(NaturalColours, NeedThreeDifferentWavelengths) {
  write_spectrum({0.55, 1.6, 2.1});  // 0.55 is nearest to two of the display's colours
  options_.variable = "camera_eye";
  draw();
  EXPECT_THAT(report_.colours, HasSubstr("colours from"));
}

TEST_F(NaturalColours, Mistakes) {
  write_spectrum();
  const auto message = [this](auto change) {
    RenderOptions wrong = options_;
    change(wrong);
    try {
      render(wrong);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(message([](auto& o) { o.tone = "soft"; }), AllOf(HasSubstr("soft"), HasSubstr("filmic, linear")));
  EXPECT_THAT(message([](auto& o) { o.exposure = 2; }), AllOf(HasSubstr("upwelling_flux"), HasSubstr("camera_NAME")));
  options_.variable = "camera_eye";
  EXPECT_THAT(message([](auto& o) { o.exposure = 0; }), HasSubstr("> 0"));
  EXPECT_THAT(message([](auto& o) { o.exposure = 2, o.colormap = "grey"; }), HasSubstr("exclude"));
  EXPECT_THAT(message([](auto& o) { o.variable = "camera_ear"; }),
              AllOf(HasSubstr("camera_ear"), HasSubstr("camera_eye")));
}

// Rows stand from the top in files, whatever their coordinate says: it ascended once.
TEST_F(NaturalColours, CameraStandsUprightByAscendingRows) {
  write_spectrum();
  options_.variable = "camera_eye";
  const Picture now = draw();
  const hid_t file = H5Fopen(options_.result_file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t rows = H5Dopen2(file, "row_eye", H5P_DEFAULT);
  const std::array<double, 2> ascending{0.5, 1.5};
  EXPECT_GE(H5Dwrite(rows, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, ascending.data()), 0);
  H5Dclose(rows);
  H5Fclose(file);
  EXPECT_EQ(draw().rgba, now.rgba);
}

TEST_F(NaturalColours, FluxesOfASpectrumAreMapsOfOneWavelength) {
  write_spectrum();
  options_.wavelength_um = 0.45;
  draw();
  EXPECT_EQ(report_.image.wavelength_um, 0.45);
  EXPECT_EQ(report_.image.place, "z = 530 m");
  EXPECT_EQ(report_.min, sample::field_value(1, 1, 0, 0));
}

// Truth: the layout of the format, byte by byte ("OpenEXR File Layout").
TEST_F(NaturalColours, ExrHoldsTheNumbers) {
  write_spectrum();
  options_.variable = "camera_eye";
  options_.image_file = folder_ / "r.exr";
  render(options_);
  std::ifstream in(options_.image_file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const auto at = [&](std::size_t place, auto value) {
    std::memcpy(&value, bytes.data() + place, sizeof value);
    return value;
  };
  EXPECT_EQ(at(0, std::int32_t{}), 20000630);
  EXPECT_EQ(at(4, std::int32_t{}), 2);
  EXPECT_EQ(bytes.substr(8, 16), std::string("channels\0chlist\0", 16));
  EXPECT_EQ(at(24, std::int32_t{}), 3 * 18 + 1);
  EXPECT_EQ(bytes.substr(28, 2), std::string("B\0", 2));
  // Two lines of place, size, and two values of each of three channels.
  const std::size_t line = 8 + 3 * 2 * 4;
  const std::size_t first = bytes.size() - 2 * line;
  EXPECT_EQ(at(first - 16, std::uint64_t{}), first);
  EXPECT_EQ(at(first - 8, std::uint64_t{}), first + line);
  EXPECT_EQ(at(first, std::int32_t{}), 0);
  EXPECT_EQ(at(first + 4, std::int32_t{}), 24);
  EXPECT_EQ(at(first + 8 + 4, float{}), 0);        // blue of the pixel at the top right
  EXPECT_EQ(at(first + 8 + 12, float{}), 0.5F);    // green
  EXPECT_EQ(at(first + 8 + 20, float{}), 2);       // red
  EXPECT_EQ(at(first + line, std::int32_t{}), 1);  // the line below it
  EXPECT_EQ(at(first + line + 8, float{}), 1);
  EXPECT_EQ(at(first + line + 12, float{}), 0);  // if there is no value
}

TEST_F(NaturalColours, ImagesAreBareUnlessAFigureIsAskedFor) {
  write_spectrum();
  options_.variable = "camera_eye";
  options_.form = RenderForm::automatic;
  EXPECT_EQ(draw().width, 2);
  options_.form = RenderForm::figure;
  EXPECT_EQ(draw().width, 1200);
  EXPECT_THAT(report_.colours, HasSubstr("natural colours"));
  options_.variable = "reflectance_factor_above";
  options_.wavelength_um = 0.55;
  EXPECT_EQ(draw().width, 1200);
  EXPECT_EQ(report_.min, 0.25);  // pi I / (mu0 F0) as the file has it
  EXPECT_EQ(report_.max, 1);
}

}  // namespace
}  // namespace cloudbow
