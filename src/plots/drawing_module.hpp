// Functions of the module cloudbow_drawing, which uses Cairo and Pango, for drawing.cpp. Loading the two takes longer
// than many commands, so they are loaded with the first figure.
#pragma once

#include "plots/drawing.hpp"

namespace cloudbow {

enum class DrawingFormat { png, svg, pdf };

struct DrawingModule {
  /// Empty, or the reason for which nothing can be drawn.
  std::string (*find_fonts)();
  TextSize (*measure)(const DrawnText& text);
  /// The bytes of the file. @param scale pixels per point, of PNG
  std::vector<std::uint8_t> (*paint)(const Drawing& drawing, DrawingFormat format, double scale);
};

}  // namespace cloudbow

/// The module's one symbol.
extern "C" const cloudbow::DrawingModule cloudbow_drawing_module;
