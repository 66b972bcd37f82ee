// Results so small that every pixel of their pictures can be computed by hand; the pictures, read again.
#pragma once

#include <gmock/gmock.h>
#include <png.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "../io/sample_solution.hpp"
#include "cloudbow/plots/render.hpp"

namespace cloudbow {

namespace fs = std::filesystem;

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;

  int channel(int x, int y, int c) const { return rgba[static_cast<std::size_t>(4 * (y * width + x) + c)]; }
  int red(int x, int y) const { return channel(x, y, 0); }
  int alpha(int x, int y) const { return channel(x, y, 3); }
};

inline Picture read_png(const fs::path& file) {
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
    options_.form = RenderForm::bare;
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

/// Reflectance factors of a camera of 2 x 2 and an image of 1 x 2 pixels. The sun is such that pi I / (mu0 F0) is the
/// number given.
inline Solution natural(const std::vector<float>& camera, const std::vector<float>& image) {
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

}  // namespace cloudbow
