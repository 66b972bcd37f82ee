// From what is seen to what a display shows. docs/pictures.md.
#pragma once

#include <string>
#include <vector>

namespace cloudbow {

/// Part of the display's range, 0 to 1 in linear light, for a reflectance factor times the exposure, >= 0:
/// "linear" min(x, 1); "filmic" 1 - 5^-x: a white card (x = 1) is at 0.8, and brighter values still differ.
/// @throws InputError for another name.
double display_level(const std::string& tone, double x);

/// The exposure with which all but the brightest hundredth of the luminance values stay below a white card; 1 if there
/// is no light.
double automatic_exposure(std::vector<float> luminance);

}  // namespace cloudbow
