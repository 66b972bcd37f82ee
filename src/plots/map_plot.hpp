// Figures of maps, sections and images: a picture in a frame, with a scale of its colours.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cloudbow/io/png_file.hpp"
#include "plots/cloud_outline.hpp"
#include "plots/frame.hpp"

namespace cloudbow {

struct ColourScale {
  PlotAxis axis;  ///< name and unit of the values
  std::pair<double, double> range;
  std::vector<Rgb> colours;  ///< from the first to the last value
};

struct MapPlot {
  std::string title;                    ///< plain text
  std::string subtitle;                 ///< plain text, smaller
  Frame frame;                          ///< axes and their ranges
  bool has_axes = true;                 ///< without: the outline alone, for images of cameras
  double aspect = 1;                    ///< height over width of the frame
  DrawnPicture picture;                 ///< fills the frame
  std::vector<OutlinePiece> outline{};  ///< over the picture, in the units of the axes
  std::optional<ColourScale> scale{};
};

/// A figure as wide as figure_width, and as high as the map needs. A flat map has its scale of colours below, others at
/// the right.
Drawing map_figure(MapPlot plot);

}  // namespace cloudbow
