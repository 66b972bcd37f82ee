#include "cloudbow/plots/render.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <tuple>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/output_files.hpp"
#include "cloudbow/io/exr_file.hpp"
#include "cloudbow/io/picture_format.hpp"
#include "cloudbow/io/png_file.hpp"
#include "plots/colormap.hpp"
#include "plots/tone_curve.hpp"

namespace cloudbow {

namespace {

constexpr int colour_count = 255;
constexpr double longer_side = 768;
constexpr double largest_side = 16384;
/// A section is stretched if it would be flatter or steeper than this: atmospheres are much wider or higher than a
/// screen.
constexpr double section_aspect = 4;

/// Wavelengths [um] of a spectrum that represent the display's red, green and blue.
constexpr std::array<double, 3> natural_wavelengths_um{0.67, 0.55, 0.45};
constexpr std::array<double, 3> luminance_weights{0.2126, 0.7152, 0.0722};  // of the display's colours, ITU-R BT.709

bool is_map(const FluxImage& image) { return !image.place.starts_with("section") && image.place != "column"; }

/// Height over width of the picture.
double aspect_of(const FluxImage& image) {
  if (image.place == "column") return 1;
  const double aspect = (image.row_edge_m.back() - image.row_edge_m.front()) / (image.columns * image.column_width_m);
  return is_map(image) ? aspect : std::clamp(aspect, 1 / section_aspect, section_aspect);
}

void set_size(RenderReport& report, int scale) {
  const double aspect = aspect_of(report.image);
  const double cells = report.image.place == "column" ? report.image.rows : report.image.columns;
  const double pixels_a_cell = scale > 0 ? scale
                               : report.image.place == "camera"
                                   ? 1
                                   : std::max(1.0, std::round(longer_side / (cells * std::max(1.0, aspect))));
  const double width = cells * pixels_a_cell;
  const double height = std::max(1.0, std::round(width * aspect));
  if (std::max(width, height) > largest_side) {
    throw InputError(fmt::format("scale: {} pixels a cell make an image of {} x {}, at most {} x {} are allowed",
                                 pixels_a_cell, width, height, largest_side, largest_side));
  }
  report.width = static_cast<int>(width);
  report.height = static_cast<int>(height);
}

void set_range(RenderReport& report, const RenderOptions& options) {
  if (options.range) {
    std::tie(report.min, report.max) = *options.range;
    if (!(std::isfinite(report.min) && std::isfinite(report.max) && report.min != report.max)) {
      throw InputError(fmt::format(
          "range: {} to {} is not a range (two different numbers; the larger one first turns the colours round)",
          report.min, report.max));
    }
    return;
  }
  report.min = std::numeric_limits<double>::infinity();
  report.max = -report.min;
  for (const float value : report.image.value) {
    if (!std::isfinite(value)) continue;
    report.min = std::min(report.min, static_cast<double>(value));
    report.max = std::max(report.max, static_cast<double>(value));
  }
  if (report.min > report.max) {
    throw InputError(fmt::format("{}: {} has no value at all here ({}): nothing to draw", options.result_file.string(),
                                 options.variable, report.image.place));
  }
}

std::uint8_t colour_index(float value, double min, double max) {
  if (!std::isfinite(value)) return 0;
  const double t = max != min ? std::clamp((value - min) / (max - min), 0.0, 1.0) : 0.5;
  return static_cast<std::uint8_t>(1 + std::lround(t * (colour_count - 1)));
}

/// For each pixel, row by row from the top, the place of its value in FluxImage::value.
std::vector<std::size_t> cells_of_pixels(const RenderReport& report) {
  const FluxImage& image = report.image;
  std::vector<std::size_t> cell;
  cell.reserve(static_cast<std::size_t>(report.width) * static_cast<std::size_t>(report.height));
  const double bottom = image.row_edge_m.front();
  const double top = image.row_edge_m.back();
  for (int py = 0; py < report.height; ++py) {
    const double height = top - (py + 0.5) / report.height * (top - bottom);
    const auto above = std::upper_bound(image.row_edge_m.begin() + 1, image.row_edge_m.end() - 1, height);
    const auto row = static_cast<std::size_t>(above - image.row_edge_m.begin() - 1);
    for (int px = 0; px < report.width; ++px) {
      const auto column = static_cast<std::size_t>(static_cast<std::int64_t>(px) * image.columns / report.width);
      cell.push_back(row * static_cast<std::size_t>(image.columns) + column);
    }
  }
  return cell;
}

IndexedImage draw(const RenderReport& report, std::vector<Rgb> colour) {
  IndexedImage picture{report.width, report.height, {}, std::move(colour)};
  for (const std::size_t cell : cells_of_pixels(report))
    picture.index.push_back(colour_index(report.image.value[cell], report.min, report.max));
  return picture;
}

/// Images of the display's red, green and blue: three, or one for grey; and their description in words.
struct Channels {
  std::vector<FluxImage> image;
  std::string name;
};

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

/// Reflectance factors for a tone curve; none if the options or the file require a colormap.
std::optional<Channels> find_channels(const RenderOptions& options) {
  const bool toned = !options.tone.empty() || options.exposure || options.automatic_exposure;
  if (toned && (options.range || !options.colormap.empty())) {
    throw InputError("tone and exposure exclude range and colormap (found both, allowed one of the two)");
  }
  if (options.range || !options.colormap.empty()) return std::nullopt;
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

/// Black for pixels without value.
RgbImage draw_natural(const RenderReport& report, const Channels& channels, const std::string& tone, double exposure) {
  RgbImage picture{report.width, report.height, {}};
  const std::size_t last = channels.image.size() - 1;
  for (const std::size_t cell : cells_of_pixels(report)) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = channels.image[std::min(c, last)].value[cell];
      picture.rgb.push_back(std::isfinite(value) ? srgb_byte(display_level(tone, exposure * value)) : std::uint8_t{0});
    }
  }
  return picture;
}

FloatImage draw_numbers(const RenderReport& report, const std::vector<FluxImage>& images) {
  FloatImage picture{report.width, report.height, {}};
  const std::vector<std::size_t> cells = cells_of_pixels(report);
  const std::array<const char*, 3> names{"R", "G", "B"};
  for (std::size_t c = 0; c < images.size(); ++c) {
    FloatImage::Channel channel{images.size() == 1 ? "Y" : names[c], {}};
    for (const std::size_t cell : cells) {
      const float value = images[c].value[cell];
      channel.value.push_back(std::isfinite(value) ? value : 0);
    }
    picture.channel.push_back(std::move(channel));
  }
  return picture;
}

void check_options(const RenderOptions& options) {
  if (options.scale < 0) throw InputError(fmt::format("scale: {} is not a number of pixels >= 1", options.scale));
  check_outputs({{options.image_file, "the picture", OutputKind::picture}}, std::span(&options.result_file, 1));
}

}  // namespace

RenderReport render(const RenderOptions& options) {
  const std::string tone = options.tone.empty() ? "filmic" : options.tone;
  display_level(tone, 0);  // throws for an unknown name
  auto colour = make_colormap(options.colormap.empty() ? "grey" : options.colormap, colour_count);
  check_options(options);
  const bool is_exr = picture_format(options.image_file, OutputKind::picture) == PictureFormat::exr;
  RenderReport report;
  const std::optional<Channels> channels = find_channels(options);
  report.image = channels
                     ? channels->image.front()
                     : read_flux_image(options.result_file, options.variable, {options.level, options.wavelength_um});
  set_range(report, options);
  set_size(report, is_exr && options.scale == 0 ? 1 : options.scale);
  if (is_exr) {
    write_exr(options.image_file, draw_numbers(report, channels ? channels->image : std::vector{report.image}));
    report.colours = fmt::format("{}, numbers as they are", channels ? channels->name : "brightness");
  } else if (channels) {
    const double exposure = exposure_of(options, *channels);
    write_png(options.image_file, draw_natural(report, *channels, tone, exposure));
    report.colours = fmt::format("{}, {} tone, exposure {:.4g}", channels->name, tone, exposure);
  } else {
    write_png(options.image_file, draw(report, std::move(colour)));
    report.colours = fmt::format("colours from {:.4g} to {:.4g}", report.min, report.max);
  }
  return report;
}

}  // namespace cloudbow
