#include "plots/drawing.hpp"

#include <cmath>

#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/module.hpp"
#include "cloudbow/io/picture_format.hpp"
#include "plots/drawing_module.hpp"

namespace cloudbow {

namespace {

constexpr double pixels_per_point = 8.0 / 3;  // 450 points are 1200 pixels

const DrawingModule& drawing_module() {
  static const DrawingModule& module = []() -> const DrawingModule& {
    // Measured: 60 MB of libraries and fonts. Pango looks for fonts in two threads and ends the program if one cannot
    // start. The C library reserves 134 MB of addresses for the allocations of the first.
    const void* const symbol = load_module("cloudbow_drawing.so", "cloudbow_drawing_module",
                                           {"Cairo and Pango", "draws figures", 234'000'000, 4});
    const auto& loaded = *static_cast<const DrawingModule*>(symbol);
    if (const std::string reason = loaded.find_fonts(); !reason.empty())
      throw InputError("figure: " + reason + " (found none, allowed any) install one, such as fonts-dejavu-core");
    return loaded;
  }();
  return module;
}

DrawingFormat drawing_format(const std::filesystem::path& file) {
  switch (picture_format(file)) {
    case PictureFormat::svg:
      return DrawingFormat::svg;
    case PictureFormat::pdf:
      return DrawingFormat::pdf;
    default:
      return DrawingFormat::png;
  }
}

}  // namespace

TextSize measure_text(const DrawnText& text) { return drawing_module().measure(text); }

PlotBox text_box(const DrawnText& text) {
  const TextSize size = measure_text(text);
  const double across = size.width * (text.anchor == TextAnchor::left     ? 0
                                      : text.anchor == TextAnchor::centre ? 0.5
                                                                          : 1);
  const double above = text.hold == TextHold::top ? 0 : size.height / 2;
  if (text.turn == TextTurn::none) {
    return {text.place.x - across, text.place.y - above, text.place.x - across + size.width,
            text.place.y - above + size.height};
  }
  return {text.place.x - above, text.place.y + across - size.width, text.place.x - above + size.height,
          text.place.y + across};
}

void fit_text(DrawnText& text, int lines, double least_size) {
  constexpr double step = 0.9;
  while (measure_text(text).lines > lines && text.size * step >= least_size) text.size *= step;
  text.max_lines = lines;
}

std::array<int, 2> write_drawing(const std::filesystem::path& file, const Drawing& drawing, int pixel_width) {
  const DrawingFormat format = drawing_format(file);
  const double scale = format != DrawingFormat::png ? 1
                       : pixel_width > 0            ? pixel_width / drawing.width
                                                    : pixels_per_point;
  write_file_atomically(file, drawing_module().paint(drawing, format, scale));
  return {static_cast<int>(std::lround(scale * drawing.width)), static_cast<int>(std::lround(scale * drawing.height))};
}

}  // namespace cloudbow
