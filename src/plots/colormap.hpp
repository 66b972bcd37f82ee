// Colour maps: computed ones, in which equal steps of value are equal steps of lightness L* (CIE 1976), and published
// ones.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cloudbow/io/png_file.hpp"

namespace cloudbow {

/// A part of what the display can do, 0 to 1 in linear light, as the byte of an sRGB picture (IEC 61966-2-1); clamped.
std::uint8_t srgb_byte(double linear);

constexpr const char* diverging_colormap = "blue-red";

/// `size` sRGB colours, from dark to light but of the last. "grey": L* 0 to 100 without colour; "blue-yellow": L* 20 to
/// 92, from blue over green to yellow; "viridis" and "cividis": as published (colormap_tables.hpp), to 1/255 if `size`
/// is not 256; "blue-red": L* 38 to 96 and back to 38, from blue over near-white to red.
/// @throws InputError for another name.
std::vector<Rgb> make_colormap(const std::string& name, int size);

}  // namespace cloudbow
