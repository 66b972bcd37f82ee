#include "cloudbow/io/picture_format.hpp"

namespace cloudbow {

PictureFormat picture_format(const std::filesystem::path& file, OutputKind kind) {
  check_ending({file, kind == OutputKind::plot ? "the plot" : "the picture", kind});
  const std::string ending = name_ending(file);
  if (ending == ".exr") return PictureFormat::exr;
  if (ending == ".svg") return PictureFormat::svg;
  return ending == ".pdf" ? PictureFormat::pdf : PictureFormat::png;
}

}  // namespace cloudbow
