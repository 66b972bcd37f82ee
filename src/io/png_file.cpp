#include "cloudbow/io/png_file.hpp"

#include <fmt/format.h>
#include <png.h>

#include <cassert>

#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/io/picture_format.hpp"

namespace cloudbow {

namespace {

void check_png(const std::filesystem::path& file) {
  if (picture_format(file) == PictureFormat::png) return;
  throw InputError(fmt::format("{}: pixels alone are no SVG or PDF (found {}, allowed .png)", file.string(),
                               file.extension().string()));
}

/// @param png format and size set
std::vector<std::uint8_t> encode(const std::filesystem::path& file, png_image& png,
                                 const std::vector<std::uint8_t>& pixels, const void* colormap) {
  png_alloc_size_t bytes = 0;
  std::vector<std::uint8_t> encoded;
  bool good = png_image_write_to_memory(&png, nullptr, &bytes, 0, pixels.data(), 0, colormap) != 0;
  if (good) {
    encoded.resize(bytes);
    good = png_image_write_to_memory(&png, encoded.data(), &bytes, 0, pixels.data(), 0, colormap) != 0;
  }
  if (!good) throw_unwritable(file, png.message);
  encoded.resize(bytes);
  return encoded;
}

png_image make_png(int width, int height, png_uint_32 format) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(width);
  png.height = static_cast<png_uint_32>(height);
  png.format = format;
  return png;
}

}  // namespace

void write_png(const std::filesystem::path& file, const IndexedImage& image) {
  check_png(file);
  assert(image.colour.size() <= 255 &&
         image.index.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  std::vector<std::uint8_t> colormap(4, 0);
  for (const Rgb& colour : image.colour) colormap.insert(colormap.end(), {colour[0], colour[1], colour[2], 255});
  png_image png = make_png(image.width, image.height, PNG_FORMAT_RGBA_COLORMAP);
  png.colormap_entries = static_cast<png_uint_32>(colormap.size() / 4);
  write_file_atomically(file, encode(file, png, image.index, colormap.data()));
}

void write_png(const std::filesystem::path& file, const RgbImage& image) {
  check_png(file);
  assert(image.rgb.size() == 3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  png_image png = make_png(image.width, image.height, PNG_FORMAT_RGB);
  write_file_atomically(file, encode(file, png, image.rgb, nullptr));
}

}  // namespace cloudbow
