#include "cloudbow/io/picture_format.hpp"

namespace cloudbow {

PictureFormat picture_format(const std::filesystem::path& file, OutputKind kind) {
  check_ending({file, kind == OutputKind::plot ? "the plot" : "the picture", kind});
  return name_ending(file) == ".exr" ? PictureFormat::exr : PictureFormat::png;
}

}  // namespace cloudbow
