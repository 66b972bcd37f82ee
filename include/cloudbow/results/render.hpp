// Pictures of result files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cloudbow/results/flux_image.hpp"

namespace cloudbow {

struct RenderOptions {
  std::filesystem::path result_file;
  std::filesystem::path image_file;         ///< PNG
  std::string variable = "upwelling_flux";  ///< a root variable with the dimensions y, x
  std::string level = "top";                ///< "top", "bottom" or a height in metres
  std::optional<std::pair<double, double>>
      range;                      ///< values of the first and last colour; default: smallest and largest value
  int scale = 0;                  ///< pixels a cell, nearest neighbour; 0: so that the longer side is about 768 pixels
  std::string colormap = "grey";  ///< one of colormap_names()
};

/// What the picture shows, for a line on the terminal.
struct RenderReport {
  FluxImage image;
  int width = 0;  ///< pixels
  int height = 0;
  double min = 0;  ///< value of the first colour
  double max = 0;  ///< value of the last colour
};

std::vector<std::string> colormap_names();

/// Draws a map with x to the right and y up (a result with one row of cells: a section with z up) into a PNG,
/// atomically. Cells without value are transparent.
/// @throws InputError for files that can't be read or written and for options out of range, listing what is there or
/// allowed.
RenderReport render(const RenderOptions& options);

}  // namespace cloudbow
