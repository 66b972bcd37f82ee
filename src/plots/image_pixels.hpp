// From the pixels of a picture to the values of an image.
#pragma once

#include <cstddef>
#include <vector>

#include "cloudbow/io/flux_image.hpp"

namespace cloudbow {

/// For each pixel of a picture, row by row from the top, the index of its value in FluxImage::value. Rows of uneven
/// height have as many pixels as their height asks for.
std::vector<std::size_t> cells_of_pixels(const FluxImage& image, int width, int height);

/// For each pixel its value: that of its cell, or between two levels the linear interpolation in height. Beside a level
/// without a value, it is that of the nearer level.
std::vector<float> values_of_pixels(const FluxImage& image, int width, int height);

/// Whether the image is a horizontal map or that of a camera, and not a vertical section.
bool is_map(const FluxImage& image);

/// Height over width of the picture. Sections are stretched if they would be flatter or steeper than 1 : 4, because
/// atmospheres are much wider or higher than a screen.
double aspect_of(const FluxImage& image);

}  // namespace cloudbow
