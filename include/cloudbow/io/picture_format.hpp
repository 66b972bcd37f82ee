// Kind of picture that a file name implies.
#pragma once

#include <filesystem>

#include "cloudbow/core/output_files.hpp"

namespace cloudbow {

enum class PictureFormat { png, svg, pdf, exr };

/// By the ending of the name, in letters of any size; a name without one means PNG.
/// @param kind plot, which is PNG, SVG or PDF, or picture
/// @throws InputError for any other ending (check_ending())
PictureFormat picture_format(const std::filesystem::path& file, OutputKind kind = OutputKind::plot);

}  // namespace cloudbow
