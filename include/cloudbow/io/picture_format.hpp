// Which kind of picture a file name asks for.
#pragma once

#include <filesystem>
#include <vector>

namespace cloudbow {

enum class PictureFormat { png, exr };

/// By the ending of the name, in letters of any size; a name without one asks for PNG.
/// @param written the kinds that the caller can write
/// @throws InputError for any other ending: a PNG file by the name of a JPEG deceives whoever opens it.
PictureFormat picture_format(const std::filesystem::path& file,
                             const std::vector<PictureFormat>& written = {PictureFormat::png});

}  // namespace cloudbow
