#include "png_file.hpp"

#include <fcntl.h>
#include <png.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <system_error>

#include "atomic_file.hpp"

namespace cloudbow {

namespace {

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

/// Returns errno.
int write_bytes(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  int error = 0;
  for (std::size_t done = 0; done < bytes.size() && error == 0;) {
    const ssize_t written = write(descriptor, bytes.data() + done, bytes.size() - done);
    if (written > 0) {
      done += static_cast<std::size_t>(written);
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  const int close_error = close(descriptor) == 0 ? 0 : errno;
  return error != 0 ? error : close_error;
}

void write_atomically(const std::filesystem::path& file, const std::vector<std::uint8_t>& encoded) {
  AtomicFile target(file);
  if (const int error = write_bytes(target.temporary(), encoded))
    throw_unwritable(file, std::generic_category().message(error));
  target.commit();
}

}  // namespace

void write_png(const std::filesystem::path& file, const IndexedImage& image) {
  assert(image.colour.size() <= 255 &&
         image.index.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  std::vector<std::uint8_t> colormap(4, 0);
  for (const Rgb& colour : image.colour) colormap.insert(colormap.end(), {colour[0], colour[1], colour[2], 255});
  png_image png = make_png(image.width, image.height, PNG_FORMAT_RGBA_COLORMAP);
  png.colormap_entries = static_cast<png_uint_32>(colormap.size() / 4);
  write_atomically(file, encode(file, png, image.index, colormap.data()));
}

void write_png(const std::filesystem::path& file, const RgbImage& image) {
  assert(image.rgb.size() == 3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  png_image png = make_png(image.width, image.height, PNG_FORMAT_RGB);
  write_atomically(file, encode(file, png, image.rgb, nullptr));
}

}  // namespace cloudbow
