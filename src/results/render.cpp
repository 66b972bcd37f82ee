#include "cloudbow/results/render.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "cloudbow/core/error.hpp"
#include "png_file.hpp"

namespace cloudbow {

namespace {

constexpr int kColours = 255;
constexpr double kLongerSide = 768;
constexpr double kLargestSide = 16384;
/// A section is stretched where it would be flatter or steeper than this: atmospheres are much wider or higher than a
/// screen.
constexpr double kSectionAspect = 4;

bool is_map(const FluxImage& image) { return !image.place.starts_with("section") && image.place != "column"; }

/// Height over width of the picture.
double aspect_of(const FluxImage& image) {
  if (image.place == "column") return 1;
  const double aspect = (image.row_edge_m.back() - image.row_edge_m.front()) / (image.columns * image.column_width_m);
  return is_map(image) ? aspect : std::clamp(aspect, 1 / kSectionAspect, kSectionAspect);
}

void set_size(RenderReport& report, int scale) {
  const double aspect = aspect_of(report.image);
  const double cells = report.image.place == "column" ? report.image.rows : report.image.columns;
  const double pixels_a_cell =
      scale > 0 ? scale : std::max(1.0, std::round(kLongerSide / (cells * std::max(1.0, aspect))));
  const double width = cells * pixels_a_cell;
  const double height = std::max(1.0, std::round(width * aspect));
  if (std::max(width, height) > kLargestSide) {
    throw InputError(fmt::format("scale: {} pixels a cell make an image of {} x {}, at most {} x {} are allowed",
                                 pixels_a_cell, width, height, kLargestSide, kLargestSide));
  }
  report.width = static_cast<int>(width);
  report.height = static_cast<int>(height);
}

void set_range(RenderReport& report, const RenderOptions& options) {
  if (options.range) {
    std::tie(report.min, report.max) = *options.range;
    if (!(std::isfinite(report.min) && std::isfinite(report.max) && report.min < report.max)) {
      throw InputError(
          fmt::format("range: {} to {} is not a range (two numbers, the smaller one first)", report.min, report.max));
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
  const double t = max > min ? std::clamp((value - min) / (max - min), 0.0, 1.0) : 0.5;
  return static_cast<std::uint8_t>(1 + std::lround(t * (kColours - 1)));
}

IndexedImage draw(const RenderReport& report, std::vector<Rgb> colour) {
  const FluxImage& image = report.image;
  IndexedImage picture{report.width, report.height, {}, std::move(colour)};
  picture.index.reserve(static_cast<std::size_t>(report.width) * static_cast<std::size_t>(report.height));
  const double bottom = image.row_edge_m.front();
  const double top = image.row_edge_m.back();
  for (int py = 0; py < report.height; ++py) {
    const double height = top - (py + 0.5) / report.height * (top - bottom);
    const auto above = std::upper_bound(image.row_edge_m.begin() + 1, image.row_edge_m.end() - 1, height);
    const auto row = static_cast<std::size_t>(above - image.row_edge_m.begin() - 1);
    for (int px = 0; px < report.width; ++px) {
      const auto column = static_cast<std::size_t>(static_cast<std::int64_t>(px) * image.columns / report.width);
      const float value = image.value[row * static_cast<std::size_t>(image.columns) + column];
      picture.index.push_back(colour_index(value, report.min, report.max));
    }
  }
  return picture;
}

}  // namespace

RenderReport render(const RenderOptions& options) {
  auto colour = make_colormap(options.colormap, kColours);
  if (options.scale < 0) throw InputError(fmt::format("scale: {} is not a number of pixels >= 1", options.scale));
  std::error_code error;
  if (std::filesystem::equivalent(options.result_file, options.image_file, error)) {
    throw InputError(
        fmt::format("{}: is the result file itself, name another file for the image", options.image_file.string()));
  }
  RenderReport report;
  report.image = read_flux_image(options.result_file, options.variable, options.level);
  set_range(report, options);
  set_size(report, options.scale);
  write_png(options.image_file, draw(report, std::move(colour)));
  return report;
}

}  // namespace cloudbow
