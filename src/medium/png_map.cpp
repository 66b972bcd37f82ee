// Grey levels of a PNG as numbers: no gamma, no colour space.
#include <png.h>

#include <array>
#include <csetjmp>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>

#include "albedo_map_readers.hpp"

namespace cloudbow {
namespace {

/// libpng leaves a function that fails by longjmp, which must not pass objects with destructors: the two functions that
/// call setjmp have none.
class PngReader {
 public:
  explicit PngReader(std::FILE* file) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, [](png_structp, png_const_charp) {});
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ == nullptr) throw std::bad_alloc();
    png_init_io(png_, file);
  }
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  /// Levels of 8 or 16 bits, palettes as colours, transparency as alpha.
  bool read_head() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_info(png_, info_);
    png_set_expand(png_);
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    return true;
  }
  bool read_rows(png_bytep* row) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_image(png_, row);
    png_read_end(png_, nullptr);
    return true;
  }

  std::size_t width() const { return png_get_image_width(png_, info_); }
  std::size_t height() const { return png_get_image_height(png_, info_); }
  std::size_t channels() const { return png_get_channels(png_, info_); }
  std::size_t channel_bytes() const { return png_get_bit_depth(png_, info_) / 8; }
  std::size_t row_bytes() const { return png_get_rowbytes(png_, info_); }
  const std::string& message() const { return message_; }

 private:
  [[noreturn]] static void on_error(png_structp png, png_const_charp text) {
    static_cast<PngReader*>(png_get_error_ptr(png))->message_ = text;
    png_longjmp(png, 1);
  }

  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::string message_;
};

struct Pixel {
  std::array<unsigned, 4> level{};  ///< of the channels
};

Pixel pixel_at(const png_byte* at, std::size_t channels, std::size_t channel_bytes) {
  Pixel pixel;
  for (std::size_t c = 0; c < channels; ++c) {
    for (std::size_t b = 0; b < channel_bytes; ++b) pixel.level[c] = pixel.level[c] * 256 + *at++;
  }
  return pixel;
}

}  // namespace

bool is_png(const std::filesystem::path& file) {
  std::array<png_byte, 8> head{};
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail_import(file, "cannot be read (check its permissions)");
  stream.read(reinterpret_cast<char*>(head.data()), head.size());
  return png_sig_cmp(head.data(), 0, head.size()) == 0;
}

GroundMap read_png_map(const std::filesystem::path& file) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), std::fclose);
  if (stream == nullptr) fail_import(file, "cannot be read (check its permissions)");
  PngReader png(stream.get());
  if (!png.read_head()) fail_import(file, "not a PNG that can be read ({})", png.message());
  const std::size_t nx = png.width(), ny = png.height(), channels = png.channels(), bytes = png.channel_bytes();
  check_map_size(file, static_cast<double>(nx), static_cast<double>(ny));
  std::vector<png_byte> levels(ny * png.row_bytes());
  std::vector<png_bytep> row(ny);
  for (std::size_t j = 0; j < ny; ++j) row[j] = levels.data() + j * png.row_bytes();
  if (!png.read_rows(row.data())) fail_import(file, "not a PNG that can be read ({})", png.message());

  const unsigned largest = bytes == 2 ? 65535 : 255;
  const std::size_t colours = channels < 3 ? 1 : 3;
  GroundMap map{static_cast<int>(nx), static_cast<int>(ny), {}, {}};
  map.value.reserve(nx * ny);
  for (std::size_t j = ny; j-- > 0;) {
    for (std::size_t i = 0; i < nx; ++i) {
      const auto [level] = pixel_at(row[j] + i * channels * bytes, channels, bytes);
      if (colours == 3 && (level[1] != level[0] || level[2] != level[0])) {
        fail_import(file,
                    "a picture in colour (found red {}, green {}, blue {} in line {}, column {}; allowed grey levels "
                    "alone, 0 to {} for albedos of 0 to 1) a photograph holds no albedo: write the albedo as grey "
                    "levels or as netCDF, for a spectrum one file a wavelength",
                    level[0], level[1], level[2], j, i, largest);
      }
      if (channels > colours && level[colours] != largest) {
        fail_import(file, "a transparent pixel (found alpha {} in line {}, column {}; allowed {}); fill the gaps",
                    level[colours], j, i, largest);
      }
      map.value.push_back(static_cast<float>(level[0]) / static_cast<float>(largest));
    }
  }
  return map;
}

}  // namespace cloudbow
