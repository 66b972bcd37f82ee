// PNG images: of up to 255 colours and "nothing here", or of any colours.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace cloudbow {

using Rgb = std::array<std::uint8_t, 3>;

struct IndexedImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> index;  ///< [row][column], row 0 on top; 0 is transparent, i shows colour[i - 1]
  std::vector<Rgb> colour;          ///< at most 255
};

struct RgbImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< [row][column][channel], row 0 on top
};

/// Atomic, as result files are. @throws InputError if the file can't be written, or its name ends as that of another
/// kind of picture (picture_format()).
void write_png(const std::filesystem::path& file, const IndexedImage& image);
void write_png(const std::filesystem::path& file, const RgbImage& image);

}  // namespace cloudbow
