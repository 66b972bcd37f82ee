#include "plots/colormap.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "cloudbow/core/error.hpp"
#include "cloudbow/plots/render.hpp"
#include "plots/colormap_tables.hpp"

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
  constexpr double delta = 6.0 / 29.0;
  return f > delta ? f * f * f : 3 * delta * delta * (f - 4.0 / 29.0);
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

/// The chroma stays inside the gamut of sRGB along this path of hues. So no colour is clipped and the lightness is
/// exact.
Rgb blue_yellow(double t) { return srgb(20 + 72 * t, 25 + 22 * t * t * t, 290 - 195 * t); }

/// From blue over near-white to red, the two arms with the same lightness. The chroma rises inside the gamut of sRGB.
Rgb blue_red(double t) {
  const double strength = std::abs(2 * t - 1);
  return srgb(96 - 58 * strength, 60 * std::pow(strength, 0.9), t < 0.5 ? 250 + 40 * strength : 32);
}

int hex_digit(char c) { return c <= '9' ? c - '0' : c - 'a' + 10; }

/// A colour of a published list, linearly between its neighbours. @param t 0 to 1
Rgb listed(std::string_view hexadecimal, double t) {
  constexpr std::size_t hex_digits = 6;  // of a colour
  const std::size_t last = hexadecimal.size() / hex_digits - 1;
  const double place = t * static_cast<double>(last);
  const std::size_t low = std::min(static_cast<std::size_t>(place), last - 1);
  const double share = place - static_cast<double>(low);
  const auto byte = [&](std::size_t colour, std::size_t channel) {
    const std::string_view digits = hexadecimal.substr(hex_digits * colour + 2 * channel, 2);
    return 16 * hex_digit(digits[0]) + hex_digit(digits[1]);
  };
  Rgb colour;
  for (std::size_t c = 0; c < colour.size(); ++c)
    colour[c] = static_cast<std::uint8_t>(std::lround((1 - share) * byte(low, c) + share * byte(low + 1, c)));
  return colour;
}

Rgb viridis(double t) { return listed(viridis_colours, t); }
Rgb cividis(double t) { return listed(cividis_colours, t); }

struct Colormap {
  const char* name;
  Rgb (*colour)(double t);  ///< of 0 to 1
};
constexpr std::array<Colormap, 5> colormaps{{{"grey", grey},
                                             {"blue-yellow", blue_yellow},
                                             {"viridis", viridis},
                                             {"cividis", cividis},
                                             {diverging_colormap, blue_red}}};

}  // namespace

std::vector<std::string> colormap_names() {
  std::vector<std::string> names;
  for (const Colormap& map : colormaps) names.emplace_back(map.name);
  return names;
}

std::vector<Rgb> make_colormap(const std::string& name, int size) {
  const auto map = std::find_if(colormaps.begin(), colormaps.end(), [&](const auto& m) { return m.name == name; });
  if (map == colormaps.end())
    throw InputError(fmt::format("colormap: \"{}\" is not one of {}", name, fmt::join(colormap_names(), ", ")));
  std::vector<Rgb> colour;
  for (int i = 0; i < size; ++i) {
    const double t = static_cast<double>(i) / (size - 1);
    colour.push_back(map->colour(t));
  }
  return colour;
}

}  // namespace cloudbow
