// Truth: pictures small enough to compute every pixel by hand; for the colours the definition of the CIE 1976
// lightness, inverted here.
#include <gmock/gmock.h>
#include <hdf5.h>
#include <png.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

#include "../io/sample_solution.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/plots/render.hpp"
#include "plots/colormap.hpp"

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
  options_.range = {3, 1};
  const Picture round = draw();
  EXPECT_EQ(round.red(0, 0), 255) << "cold cloud tops are white in pictures of the infrared";
  EXPECT_EQ(round.red(3, 0), 0);
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
  expect(wrong, HasSubstr("grey, blue-yellow, viridis, cividis"));
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
  expect(wrong, HasSubstr("the picture would overwrite an input"));
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
  expect(folder_ / "missing.h5", "no such file");
  expect(folder_, "a directory");
  std::ofstream(folder_ / "text.h5") << "not HDF5";
  expect(folder_ / "text.h5", "can't be read as a result file");
  fs::copy(whole, folder_ / "cut.h5");
  fs::resize_file(folder_ / "cut.h5", fs::file_size(whole) / 2);
  expect(folder_ / "cut.h5", "can't be read as a result file");
}

TEST_F(Render, RefusesFilesWhosePartsDoNotFit) {
  const auto expect = [this](const std::string& reason) {
    EXPECT_THAT([&] { render(options_); }, ThrowsMessage<InputError>(AllOf(HasSubstr("r.h5"), HasSubstr(reason))));
  };
  write(sample::solution(3, 2, 2));
  hid_t file = H5Fopen(options_.result_file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(H5Lmove(file, "x", file, "other", H5P_DEFAULT, H5P_DEFAULT), 0);  // the scale's own name stays
  const hsize_t two = 2, eight = 8;
  const hid_t short_axis = H5Screate_simple(1, &two, nullptr);
  H5Dclose(H5Dcreate2(file, "x", H5T_NATIVE_DOUBLE, short_axis, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Fclose(file);
  expect("coordinate x is damaged (found 2 numbers, allowed 3");

  write(sample::solution(3, 2, 2));
  file = H5Fopen(options_.result_file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(H5Adelete_by_name(file, "upwelling_flux", "units", H5P_DEFAULT), 0);
  const hid_t many = H5Screate_simple(1, &eight, nullptr);
  const hid_t text = H5Tcopy(H5T_C_S1);
  H5Aclose(H5Acreate_by_name(file, "upwelling_flux", "units", text, many, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Tclose(text);
  H5Sclose(many);
  H5Sclose(short_axis);
  H5Fclose(file);
  expect("attribute units has 8 values, allowed one text");
}

/// Reflectance factors of a camera of 2 x 2 and an image of 1 x 2 pixels. The sun is such that pi I / (mu0 F0) is the
/// number given.
Solution natural(const std::vector<float>& camera, const std::vector<float>& image) {
  Solution solution = sample::solution(2, 2, 1);
  solution.sun = Sun{Direction(0, 0, -1), std::acos(-1.)};
  solution.images.resize(1);
  solution.images[0].view.name = "above";
  solution.images[0].view.travel = Direction(0, 0, 1);
  solution.images[0].view.width = 1;
  solution.images[0].view.height = 2;
  solution.images[0].radiance = image;
  solution.camera_images.resize(1);
  solution.camera_images[0].camera.name = "eye";
  solution.camera_images[0].camera.width = 2;
  solution.camera_images[0].camera.height = 2;
  solution.camera_images[0].radiance = camera;
  return solution;
}

class NaturalColours : public Render {
 protected:
  void write_spectrum(std::vector<double> wavelengths_um = {0.55, 0.45, 0.67, 1.6}) {
    constexpr float nothing = std::numeric_limits<float>::quiet_NaN();
    std::vector<Solution> solutions{natural({0, 0.5, 1, nothing}, {0.25, 1}), natural({0, 0, 1, nothing}, {0.5, 1}),
                                    natural({0, 2, 1, nothing}, {0.125, 1}), natural({7, 7, 7, nothing}, {7, 7})};
    solutions.resize(wavelengths_um.size(), solutions.front());
    ResultInfo info = sample::info();
    info.wavelengths_um = std::move(wavelengths_um);
    write_result(options_.result_file, solutions, info);
  }
};

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

// A PNG file by the name of another kind would deceive those who open it.
TEST_F(Render, EndingsSayTheKindOfPicture) {
  write(sample::solution(3, 2, 1, {0, 1}));
  for (const char* name : {"r.jpg", "r.pdf", "r.gif", "r.svg", "r.tif", "r.h5.bak"}) {
    options_.image_file = folder_ / name;
    EXPECT_THAT([&] { render(options_); },
                ThrowsMessage<InputError>(AllOf(HasSubstr(name), HasSubstr("allowed .png, .exr"))));
    EXPECT_FALSE(fs::exists(options_.image_file));
  }
  for (const char* name : {"r.PNG", "picture", ".png"}) {
    options_.image_file = folder_ / name;
    draw();
  }
  options_.image_file = folder_ / "r.EXR";
  render(options_);
  std::ifstream exr(options_.image_file, std::ios::binary);
  EXPECT_EQ(exr.get(), 0x76);  // the first byte of the magic number
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

}  // namespace
}  // namespace cloudbow
