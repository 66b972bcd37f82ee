// PNG images of up to 255 colours and "nothing here".
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "colormap.hpp"

namespace cloudbow {

struct IndexedImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> index;  ///< [row][column], row 0 on top; 0 is transparent, i shows colour[i - 1]
  std::vector<Rgb> colour;          ///< at most 255
};

/// Atomic, as result files are. @throws InputError where the file can't be written.
void write_png(const std::filesystem::path& file, const IndexedImage& image);

}  // namespace cloudbow
