// Texts of a drawing.
#pragma once

#include <variant>
#include <vector>

#include "plots/frame.hpp"

namespace cloudbow {

/// Boxes of its texts.
inline std::vector<PlotBox> texts(const Drawing& drawing) {
  std::vector<PlotBox> boxes;
  for (const Shape& shape : drawing.shapes) {
    if (const auto* text = std::get_if<DrawnText>(&shape)) boxes.push_back(text_box(*text));
  }
  return boxes;
}

}  // namespace cloudbow
