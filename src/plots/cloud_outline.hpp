// The outline of clouds on a vertical section.
#pragma once

#include <vector>

#include "cloudbow/io/flux_image.hpp"

namespace cloudbow {

/// A straight piece of an outline, in metres along the axes of the section.
struct OutlinePiece {
  double from_x, from_y, to_x, to_y;
};

/// The faces between cells whose extinction exceeds the threshold and cells whose extinction does not. They are joined
/// to the longest straight pieces: first those along the rows, from the bottom up, then those along the columns. The
/// rim of the section is no face.
/// @param image with FluxImage::clouds
std::vector<OutlinePiece> cloud_outline(const FluxImage& image, double threshold_per_m);

}  // namespace cloudbow
