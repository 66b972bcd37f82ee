// OpenEXR pictures of 32-bit floats, for those who develop pictures themselves.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace cloudbow {

struct FloatImage {
  struct Channel {
    std::string name;          ///< "R", "G", "B", or "Y" for brightness alone
    std::vector<float> value;  ///< [row][column], row 0 on top, linear
  };
  int width = 0;
  int height = 0;
  std::vector<Channel> channel;
};

/// One part of scan lines, not compressed (OpenEXR file layout, version 2). Atomic, as result files are.
/// @throws InputError if the file can't be written.
void write_exr(const std::filesystem::path& file, const FloatImage& image);

}  // namespace cloudbow
