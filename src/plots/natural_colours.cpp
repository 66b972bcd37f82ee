#include "plots/natural_colours.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "cloudbow/core/error.hpp"
#include "plots/colormap.hpp"
#include "plots/image_pixels.hpp"
#include "plots/tone_curve.hpp"

namespace cloudbow {

namespace {

/// Wavelengths [um] of a spectrum that represent the display's red, green and blue.
constexpr std::array<double, 3> natural_wavelengths_um{0.67, 0.55, 0.45};
constexpr std::array<double, 3> luminance_weights{0.2126, 0.7152, 0.0722};  // of the display's colours, ITU-R BT.709

/// Three different wavelengths, or none.
std::vector<double> display_wavelengths(const std::vector<double>& there_um) {
  std::vector<double> chosen;
  for (const double wanted : natural_wavelengths_um) {
    const auto nearest = std::min_element(there_um.begin(), there_um.end(), [wanted](double a, double b) {
      return std::abs(a - wanted) < std::abs(b - wanted);
    });
    if (nearest == there_um.end() || std::find(chosen.begin(), chosen.end(), *nearest) != chosen.end()) return {};
    chosen.push_back(*nearest);
  }
  return chosen;
}

/// The reflectance factor that belongs to a variable, if there is one.
std::optional<std::string> find_reflectance_factor(const RenderOptions& options) {
  const auto there = list_flux_images(options.result_file);
  for (const char* prefix : {"reflectance_factor_", "radiance_", "camera_"}) {
    if (!options.variable.starts_with(prefix)) continue;
    const std::string name = "reflectance_factor_" + options.variable.substr(std::string_view(prefix).size());
    if (std::find(there.begin(), there.end(), name) != there.end()) return name;
  }
  return std::nullopt;
}

}  // namespace

bool uses_colormap(const RenderOptions& options) {
  return options.range || options.min || options.max || !options.colormap.empty();
}

std::optional<Channels> find_channels(const RenderOptions& options) {
  const bool toned = !options.tone.empty() || options.exposure || options.automatic_exposure;
  if (toned && uses_colormap(options)) {
    throw InputError("tone and exposure exclude range and colormap (found both, allowed one of the two)");
  }
  if (uses_colormap(options)) return std::nullopt;
  const auto variable = find_reflectance_factor(options);
  if (!variable) {
    if (!toned) return std::nullopt;
    throw InputError(
        fmt::format("{}: tone and exposure need an image with reflectance factors (found {}, allowed radiance_NAME, "
                    "camera_NAME in sunlight alone)",
                    options.result_file.string(), options.variable));
  }
  Channels channels;
  const auto read = [&](std::optional<double> wavelength_um) {
    channels.image.push_back(read_flux_image(options.result_file, *variable, {options.level, wavelength_um}));
  };
  if (!options.wavelength_um) {
    for (const double um : display_wavelengths(read_wavelengths(options.result_file))) {
      read(um);
      channels.name += fmt::format("{}{:g}", channels.name.empty() ? "natural colours " : ", ", um);
    }
    if (!channels.image.empty()) {
      channels.name += " um";
      return channels;
    }
  }
  if (!toned) return std::nullopt;
  read(options.wavelength_um);
  channels.name = "grey";
  return channels;
}

double exposure_of(const RenderOptions& options, const Channels& channels) {
  if (options.exposure && options.automatic_exposure) throw InputError("exposure: both a number and automatic");
  if (options.exposure && !(std::isfinite(*options.exposure) && *options.exposure > 0)) {
    throw InputError(fmt::format("exposure: {} is not a number > 0", *options.exposure));
  }
  if (!options.automatic_exposure) return options.exposure.value_or(1);
  std::vector<float> luminance = channels.image.front().value;
  if (channels.image.size() == 3) {
    for (std::size_t n = 0; n < luminance.size(); ++n) {
      double sum = 0;
      for (std::size_t c = 0; c < 3; ++c) sum += luminance_weights[c] * channels.image[c].value[n];
      luminance[n] = static_cast<float>(sum);
    }
  }
  return automatic_exposure(std::move(luminance));
}

std::vector<std::uint8_t> natural_pixels(const Channels& channels, int width, int height, const std::string& tone,
                                         double exposure) {
  std::vector<std::uint8_t> rgb;
  const std::size_t last = channels.image.size() - 1;
  for (const std::size_t cell : cells_of_pixels(channels.image.front(), width, height)) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = channels.image[std::min(c, last)].value[cell];
      rgb.push_back(std::isfinite(value) ? srgb_byte(display_level(tone, exposure * value)) : std::uint8_t{0});
    }
  }
  return rgb;
}

}  // namespace cloudbow
