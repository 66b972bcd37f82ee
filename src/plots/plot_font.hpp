// A sans-serif stroke font: letters as lines, so that plots need no font file and scale freely.
#pragma once

#include <string_view>
#include <vector>

#include "plots/plot_canvas.hpp"

namespace cloudbow {

/// A text as lines: capitals are 1 high, the first begins at (0, 0) on the baseline, y up.
struct TextOutline {
  std::vector<std::vector<PlotPoint>> lines;
  double width = 0;
};

/// @param text UTF-8: printable ASCII and a few signs (degree, micro, times, theta, tau, mu, lambda); others become a
/// box. "^{...}" is raised, "_{...}" is lowered.
TextOutline outline(std::string_view text);

}  // namespace cloudbow
