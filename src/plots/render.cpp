#include "cloudbow/plots/render.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <tuple>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/number_text.hpp"
#include "cloudbow/core/output_files.hpp"
#include "cloudbow/io/exr_file.hpp"
#include "cloudbow/io/picture_format.hpp"
#include "cloudbow/io/png_file.hpp"
#include "plots/colormap.hpp"
#include "plots/field_figure.hpp"
#include "plots/image_pixels.hpp"
#include "plots/natural_colours.hpp"
#include "plots/tone_curve.hpp"

namespace cloudbow {

namespace {

constexpr int colour_count = 255;
constexpr double longer_side = 768;
constexpr double largest_side = 16384;
constexpr int least_width = 400, largest_width = 10000;  // of figures

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
    throw InputError(fmt::format("scale: {} pixels per cell make an image of {} x {}, at most {} x {} are allowed",
                                 pixels_a_cell, width, height, largest_side, largest_side));
  }
  report.width = static_cast<int>(width);
  report.height = static_cast<int>(height);
}

void set_range(RenderReport& report, const RenderOptions& options) {
  std::tie(report.min, report.max) =
      value_range(report.image.value, {options.colormap, options.range, options.min, options.max});
  if (!std::isfinite(report.min) || !std::isfinite(report.max)) {
    throw InputError(fmt::format("{}: {} has no value at all here ({}): nothing to draw", options.result_file.string(),
                                 options.variable, report.image.place));
  }
}

std::uint8_t colour_index(float value, double min, double max) {
  if (!std::isfinite(value)) return 0;
  const double t = max != min ? std::clamp((value - min) / (max - min), 0.0, 1.0) : 0.5;
  return static_cast<std::uint8_t>(1 + std::lround(t * (colour_count - 1)));
}

IndexedImage draw(const RenderReport& report, std::vector<Rgb> colour) {
  IndexedImage picture{report.width, report.height, {}, std::move(colour)};
  for (const std::size_t cell : cells_of_pixels(report.image, report.width, report.height))
    picture.index.push_back(colour_index(report.image.value[cell], report.min, report.max));
  return picture;
}

FloatImage draw_numbers(const RenderReport& report, const std::vector<FluxImage>& images) {
  FloatImage picture{report.width, report.height, {}};
  const std::vector<std::size_t> cells = cells_of_pixels(report.image, report.width, report.height);
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

std::optional<SectionPlane> section_of(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const bool named = text.starts_with("x=") || text.starts_with("y=");
  const auto at = named ? number_in(std::string_view(text).substr(2)) : std::nullopt;
  if (at && std::isfinite(*at)) return SectionPlane{text[0], *at};
  throw InputError(fmt::format("section: found '{}', allowed x=METRES or y=METRES", text));
}

/// Whether it shows what an eye or an instrument sees.
bool is_photograph(const FluxImage& image) {
  if (image.place == "camera") return true;
  constexpr std::array<std::string_view, 3> prefixes{"radiance_", "reflectance_factor_", "brightness_temperature_"};
  return std::ranges::any_of(prefixes, [&](std::string_view prefix) { return image.variable.starts_with(prefix); });
}

bool is_figure(const RenderOptions& options, PictureFormat format, const FluxImage& image) {
  if (format == PictureFormat::svg || format == PictureFormat::pdf) return true;
  if (options.form != RenderForm::automatic) return options.form == RenderForm::figure;
  if (format == PictureFormat::exr || options.scale > 0) return false;
  return options.width > 0 || options.title || !is_photograph(image);
}

void exclude(bool both, const char* first, const char* second) {
  if (both) throw InputError(fmt::format("{}: excludes {} (found both, allowed one of the two)", first, second));
}

/// Whether an option says how values become colours.
bool has_colours(const RenderOptions& options) {
  return uses_colormap(options) || !options.tone.empty() || options.exposure || options.automatic_exposure;
}

/// Profiles are curves over all levels, and sections contain all levels.
void check_shape(const RenderOptions& options) {
  const bool has_level = options.level.has_value();
  exclude(!options.section.empty() && has_level, "section", "level");
  if (!options.profile) return;
  exclude(!options.section.empty(), "profile", "section");
  exclude(has_level, "profile", "level");
  exclude(options.form == RenderForm::bare, "profile", "bare");
  exclude(options.scale > 0, "profile", "scale");
  exclude(options.outline.has_value(), "profile", "outline");
  exclude(options.range || options.min || options.max, "profile", "range, min and max, of colours");
  exclude(!options.colormap.empty(), "profile", "colormap");
  exclude(!options.tone.empty() || options.exposure || options.automatic_exposure, "profile", "tone and exposure");
}

void check_options(const RenderOptions& options) {
  check_outputs({{options.image_file, "the picture", OutputKind::picture}}, std::span(&options.result_file, 1));
  check_shape(options);
  if (options.scale < 0) throw InputError(fmt::format("scale: {} is not a number of pixels >= 1", options.scale));
  if (options.width != 0 && (options.width < least_width || options.width > largest_width)) {
    throw InputError(
        fmt::format("size: found {}, allowed a width from {} to {} pixels", options.width, least_width, largest_width));
  }
  exclude(options.range && (options.min || options.max), "range", "min and max");
  const bool pixels = options.form == RenderForm::bare || options.scale > 0;
  exclude(pixels && options.width > 0, options.scale > 0 ? "scale" : "bare", "size, the width of a figure");
  exclude(pixels && options.title, options.scale > 0 ? "scale" : "bare", "title");
  exclude(pixels && options.outline, options.scale > 0 ? "scale" : "bare", "outline");
  exclude(options.scale > 0 && options.form == RenderForm::figure, "scale, of pixels alone,", "figure");
  const PictureFormat format = picture_format(options.image_file, OutputKind::picture);
  if (pixels && (format == PictureFormat::svg || format == PictureFormat::pdf)) {
    throw InputError(fmt::format("{}: pixels alone (bare, scale) are no SVG or PDF (found {}, allowed .png, .exr)",
                                 options.image_file.string(), options.image_file.extension().string()));
  }
  if (format == PictureFormat::exr &&
      (options.profile || options.form == RenderForm::figure || options.title || options.width > 0)) {
    throw InputError(
        fmt::format("{}: OpenEXR has the numbers of an image and no figure (found .exr, allowed .png, "
                    ".svg, .pdf)",
                    options.image_file.string()));
  }
  if (format == PictureFormat::exr && has_colours(options)) {
    throw InputError(fmt::format(
        "{}: OpenEXR holds numbers and excludes range, min, max, colormap, tone and exposure (found .exr, allowed "
        ".png, .svg, .pdf)",
        options.image_file.string()));
  }
  exclude(options.width > 0 && (format == PictureFormat::svg || format == PictureFormat::pdf),
          "size, the width of a PNG figure", "SVG and PDF");
}

/// Clouds have an outline in sections of results that hold their extinction.
void check_outline(const FluxImage& image, const RenderOptions& options) {
  if (!options.outline) return;
  if (!(std::isfinite(*options.outline) && *options.outline >= 0))
    throw InputError(fmt::format("outline: found {}, allowed an extinction >= 0 1/m", *options.outline));
  if (*options.outline == 0 || image.clouds) return;
  const bool section = image.rows_along == "z";
  throw InputError(fmt::format("{}: no outline of clouds can be drawn (found {}, allowed {}",
                               options.result_file.string(), section ? "no variable extinction" : "a map",
                               section ? "output.fields with \"extinction\")" : "a section)"));
}

void write_figure(RenderReport& report, const RenderOptions& options, const Drawing& drawing) {
  const auto size = write_drawing(options.image_file, drawing, options.width);
  report.width = size[0];
  report.height = size[1];
  const PictureFormat format = picture_format(options.image_file, OutputKind::picture);
  if (format == PictureFormat::svg || format == PictureFormat::pdf) report.size_unit = "points";
}

RenderReport render_profile(const RenderOptions& options) {
  std::vector<std::string> variables{options.variable};
  if (options.all_fluxes) {
    const auto there = list_flux_profiles(options.result_file);
    const std::vector<std::string> fluxes{"upwelling_flux", "downwelling_diffuse_flux", "direct_flux"};
    if (std::ranges::all_of(fluxes, [&](const auto& name) { return std::ranges::count(there, name) > 0; }))
      variables = fluxes;
  }
  std::vector<FluxProfile> profiles;
  for (const std::string& variable : variables)
    profiles.push_back(read_flux_profile(options.result_file, variable, options.wavelength_um));
  // Without a sun there is no direct flux.
  if (options.all_fluxes && profiles.size() > 1)
    std::erase_if(profiles,
                  [](const FluxProfile& p) { return std::ranges::all_of(p.value, [](double v) { return v == 0; }); });
  if (profiles.empty())
    profiles.push_back(read_flux_profile(options.result_file, variables.front(), options.wavelength_um));
  RenderReport report;
  for (const FluxProfile& profile : profiles)
    report.image.variable += (report.image.variable.empty() ? "" : ", ") + profile.variable;
  report.image.units = profiles.front().units;
  report.image.place = "profile";
  report.colours = "domain means by height";
  write_figure(report, options, profile_figure(profiles, options.title.value_or(profiles.front().scene_title)));
  return report;
}

RenderReport render_image(const RenderOptions& options) {
  const std::string tone = options.tone.empty() ? "filmic" : options.tone;
  const PictureFormat format = picture_format(options.image_file, OutputKind::picture);
  RenderReport report;
  const std::optional<Channels> channels = find_channels(options);
  report.image = channels ? channels->image.front()
                          : read_flux_image(options.result_file, options.variable,
                                            {options.level, options.wavelength_um, section_of(options.section)});
  check_outline(report.image, options);
  set_range(report, options);
  const bool figure = is_figure(options, format, report.image);
  exclude(figure && report.image.place == "column" && uses_colormap(options), "a curve (a result of one column)",
          "range, min, max and colormap");
  if (!figure) set_size(report, format == PictureFormat::exr && options.scale == 0 ? 1 : options.scale);
  const std::string title = options.title.value_or(report.image.scene_title);
  const std::string range = fmt::format("colours from {:.4g} to {:.4g}", report.min, report.max);
  if (format == PictureFormat::exr) {
    write_exr(options.image_file, draw_numbers(report, channels ? channels->image : std::vector{report.image}));
    report.colours = fmt::format("{}, numbers as they are", channels ? channels->name : "brightness");
  } else if (channels) {
    const double exposure = exposure_of(options, *channels);
    const int width = figure ? report.image.columns : report.width, height = figure ? report.image.rows : report.height;
    std::vector<std::uint8_t> rgb = natural_pixels(*channels, width, height, tone, exposure);
    if (figure) {
      FluxImage shown = report.image;
      shown.long_name = channels->name;
      shown.wavelength_um.reset();
      write_figure(report, options, photograph_figure(shown, rgb, width, height, title));
    } else {
      write_png(options.image_file, RgbImage{width, height, std::move(rgb)});
    }
    report.colours = fmt::format("{}, {} tone, exposure {:.4g}", channels->name, tone, exposure);
  } else if (figure && report.image.place == "column") {
    const FluxProfile profile = read_flux_profile(options.result_file, options.variable, options.wavelength_um);
    write_figure(report, options, profile_figure({profile}, title));
    report.colours = fmt::format("values from {:.4g} to {:.4g}", report.min, report.max);
  } else if (figure) {
    const ColourScale scale = colour_scale(options.variable, report.image.units, {report.min, report.max},
                                           {options.colormap, options.range, options.min, options.max});
    write_figure(report, options,
                 field_figure(report.image, scale, title, options.outline.value_or(outline_extinction_per_m)));
    report.colours = range;
  } else {
    const std::string colormap = options.colormap.empty() ? "grey" : options.colormap;
    write_png(options.image_file, draw(report, make_colormap(colormap, colour_count)));
    report.colours = range;
  }
  return report;
}

}  // namespace

RenderReport render(const RenderOptions& options) {
  if (!options.tone.empty()) display_level(options.tone, 0);                     // throws for an unknown name
  if (!options.colormap.empty()) make_colormap(options.colormap, colour_count);  // as well
  check_options(options);
  return options.profile ? render_profile(options) : render_image(options);
}

}  // namespace cloudbow
