#include "plots/colormap.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cloudbow/core/error.hpp"
#include "cloudbow/plots/render.hpp"

namespace cloudbow {

std::uint8_t srgb_byte(double linear) {
  const double clamped = std::clamp(linear, 0.0, 1.0);
  const double encoded =
      clamped <= 0.0031308 ? 12.92 * clamped : 1.055 * std::pow(clamped, 1 / 2.4) - 0.055;  // IEC 61966-2-1
  return static_cast<std::uint8_t>(std::lround(255 * encoded));
}

namespace {

/// Inverse of the CIE 1976 function of XYZ.
double cie_inverse(double f) {
  constexpr double kDelta = 6.0 / 29.0;
  return f > kDelta ? f * f * f : 3 * kDelta * kDelta * (f - 4.0 / 29.0);
}

/// CIE 1976 lightness (0 to 100), chroma and hue angle [deg] under D65 to sRGB.
Rgb srgb(double lightness, double chroma, double hue_deg) {
  const double hue = hue_deg * std::numbers::pi / 180;
  const double fy = (lightness + 16) / 116;
  const double x = 0.95047 * cie_inverse(fy + chroma * std::cos(hue) / 500);
  const double y = cie_inverse(fy);
  const double z = 1.08883 * cie_inverse(fy - chroma * std::sin(hue) / 200);
  return {srgb_byte(3.2404542 * x - 1.5371385 * y - 0.4985314 * z),   // IEC 61966-2-1, D65
          srgb_byte(-0.9692660 * x + 1.8760108 * y + 0.0415560 * z),  //
          srgb_byte(0.0556434 * x - 0.2040259 * y + 1.0572252 * z)};
}

Rgb grey(double t) { return srgb(100 * t, 0, 0); }

/// The chroma stays inside what sRGB can show along this path of hues, so that no colour is clipped and the lightness
/// is exact.
Rgb blue_yellow(double t) { return srgb(20 + 72 * t, 25 + 22 * t * t * t, 290 - 195 * t); }

}  // namespace

std::vector<std::string> colormap_names() { return {"grey", "blue-yellow"}; }

std::vector<Rgb> make_colormap(const std::string& name, int size) {
  const auto names = colormap_names();
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    throw InputError(fmt::format("colormap: \"{}\" is not one of {}", name, fmt::join(names, ", ")));
  }
  std::vector<Rgb> colour;
  for (int i = 0; i < size; ++i) {
    const double t = static_cast<double>(i) / (size - 1);
    colour.push_back(name == "grey" ? grey(t) : blue_yellow(t));
  }
  return colour;
}

}  // namespace cloudbow
