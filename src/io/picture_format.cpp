#include "cloudbow/io/picture_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>

#include "cloudbow/core/error.hpp"

namespace cloudbow {

PictureFormat picture_format(const std::filesystem::path& file, const std::vector<PictureFormat>& written) {
  std::string ending = file.extension().string();
  if (ending.empty()) return PictureFormat::png;
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  std::string allowed;
  for (const PictureFormat format : written) {
    const char* const name = format == PictureFormat::png ? ".png" : ".exr";
    if (ending == name) return format;
    allowed += fmt::format("{}{}", allowed.empty() ? "" : ", ", name);
  }
  throw InputError(fmt::format("{}: not a kind of picture that is written (found {}, allowed {})", file.string(),
                               file.extension().string(), allowed));
}

}  // namespace cloudbow
