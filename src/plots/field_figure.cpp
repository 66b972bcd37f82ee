#include "plots/field_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "cloudbow/core/error.hpp"
#include "plots/colormap.hpp"
#include "plots/image_pixels.hpp"
#include "plots/line_plot.hpp"

namespace cloudbow {

namespace {

constexpr int colour_count = 256;
constexpr double one_sided = 0.01;
constexpr int most_pixels = 4096;
constexpr double steepest = 10;  // of maps, which are stretched beyond

/// Kilometres for long axes, metres for short ones.
struct LengthUnit {
  const char* name;
  double metres;
};

LengthUnit length_unit(double longest_m) { return longest_m >= 2000 ? LengthUnit{"km", 1000} : LengthUnit{"m", 1}; }

/// "z = 3000 m" in one line.
std::string unbroken(const std::string& text) {
  std::string joined;
  for (const char c : text) joined += c == ' ' ? std::string("\u00a0") : std::string(1, c);
  return joined;
}

/// Rows of uneven height take as many pixels as the thinnest needs, within limits; between levels values change.
int pixel_rows(const FluxImage& image) {
  constexpr int least_pixels = 1024;  // edges of uneven rows are in their place to a pixel
  double thinnest = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n + 1 < image.row_edge_m.size(); ++n)
    thinnest = std::min(thinnest, image.row_edge_m[n + 1] - image.row_edge_m[n]);
  const double height = image.row_edge_m.back() - image.row_edge_m.front();
  const double even = height / image.rows;
  if (image.level_m.empty() && even - thinnest < 1e-3 * even) return std::min(image.rows, most_pixels);
  return static_cast<int>(std::clamp(std::ceil(2 * height / thinnest), double{least_pixels}, double{most_pixels}));
}

double longest_axis_m(const FluxImage& image) {
  return std::max(image.columns * image.column_width_m, image.row_edge_m.back() - image.row_edge_m.front());
}

MapPlot map_of(const FluxImage& image, const std::string& title) {
  const double width_m = image.columns * image.column_width_m;
  const LengthUnit unit = length_unit(longest_axis_m(image));
  MapPlot plot;
  plot.title = title;
  std::vector<std::string> parts;
  if (!image.long_name.empty()) parts.push_back(image.long_name);
  if (!image.place.empty() && image.place != "camera") parts.push_back(unbroken(image.place));
  if (image.wavelength_um) parts.push_back(unbroken(fmt::format("{:g} \u00b5m", *image.wavelength_um)));
  for (const std::string& part : parts) plot.subtitle += (plot.subtitle.empty() ? "" : ", ") + part;
  plot.has_axes = image.place != "camera";
  plot.aspect = std::clamp(aspect_of(image), 1 / steepest, steepest);
  plot.frame.x = {.name = image.columns_along, .unit = unit.name};
  plot.frame.y = {.name = image.rows_along, .unit = unit.name};
  plot.frame.x_range = {image.column_start_m / unit.metres, (image.column_start_m + width_m) / unit.metres};
  plot.frame.y_range = {image.row_edge_m.front() / unit.metres, image.row_edge_m.back() / unit.metres};
  return plot;
}

/// Whether doubles lie between the two, and their difference is finite.
bool are_apart(double first, double last) {
  constexpr double least_extent = 1e-12;  // the spacing of doubles is 1e-16 of their value
  const double extent = std::abs(last - first);
  return std::isfinite(extent) && extent > least_extent * std::max(std::abs(first), std::abs(last));
}

/// @param image with clouds
void add_outline(const FluxImage& image, double threshold_per_m, MapPlot& plot) {
  plot.outline = cloud_outline(image, threshold_per_m);
  if (plot.outline.empty()) return;
  plot.subtitle += ", " + unbroken(fmt::format("line: extinction {:g} km\u207b\u00b9", 1000 * threshold_per_m));
  const double metres = length_unit(longest_axis_m(image)).metres;
  for (auto& [from_x, from_y, to_x, to_y] : plot.outline) {
    for (double* const length : {&from_x, &from_y, &to_x, &to_y}) *length /= metres;
  }
}

}  // namespace

std::pair<double, double> value_range(const std::vector<float>& values, const ColourChoice& choice) {
  if (choice.range) {
    const auto& [first, last] = *choice.range;
    if (are_apart(first, last)) return *choice.range;
    throw InputError(fmt::format(
        "range: {} to {} is not a range (two different numbers; the larger one first turns the colours round)", first,
        last));
  }
  double least = std::numeric_limits<double>::infinity(), largest = -least;
  for (const float value : values) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, static_cast<double>(value));
    largest = std::max(largest, static_cast<double>(value));
  }
  const std::pair range{choice.min.value_or(least), choice.max.value_or(largest)};
  if ((choice.min || choice.max) && !(range.first < range.second && are_apart(range.first, range.second))) {
    throw InputError(
        fmt::format("min, max: {:g} to {:g} is not a range (found values from {:g} to {:g}, allowed min < "
                    "max)",
                    range.first, range.second, least, largest));
  }
  return range;
}

ColourScale colour_scale(const std::string& variable, const std::string& unit, std::pair<double, double> range,
                         const ColourChoice& choice) {
  constexpr int ticks = 12;  // one of them is near each end
  ColourScale scale{{.name = readable_name(variable), .unit = unit, .wanted_ticks = ticks}, range, {}};
  auto& [first, last] = scale.range;
  if (first == last) {
    const double half = first == 0 ? 1 : 0.05 * std::abs(first);
    first -= half;
    last += half;
  }
  const double low = std::min(first, last), high = std::max(first, last), far = std::max(std::abs(low), std::abs(high));
  const bool both_sides = low < 0 && high > 0 && std::min(-low, high) >= one_sided * far;
  const std::string map = !choice.colormap.empty()                            ? choice.colormap
                          : both_sides || variable.starts_with("difference_") ? diverging_colormap
                                                                              : "viridis";
  const std::vector<Rgb> colours = make_colormap(map, 2 * colour_count - 1);
  for (int n = 0; n < colour_count; ++n) {
    double t = static_cast<double>(n) / (colour_count - 1);
    if (map == diverging_colormap) t = 0.5 + 0.5 * (first + t * (last - first)) / far;
    scale.colours.push_back(colours[static_cast<std::size_t>(std::lround(t * (2 * colour_count - 2)))]);
  }
  return scale;
}

std::string readable_name(const std::string& variable) {
  struct Kind {
    std::string_view prefix;
    const char* name;
  };
  constexpr std::array<Kind, 4> images{{{"radiance_", "radiance"},
                                        {"camera_", "radiance"},
                                        {"reflectance_factor_", "reflectance factor"},
                                        {"brightness_temperature_", "brightness temperature"}}};
  const auto image = std::ranges::find_if(images, [&](const Kind& kind) { return variable.starts_with(kind.prefix); });
  if (image != images.end()) return image->name;
  constexpr std::string_view difference = "difference_";
  std::string name =
      variable.starts_with(difference) ? "difference of " + variable.substr(difference.size()) : variable;
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

Drawing field_figure(const FluxImage& image, const ColourScale& scale, const std::string& title, double outline_per_m) {
  MapPlot plot = map_of(image, title);
  plot.scale = scale;
  if (image.clouds && outline_per_m > 0) add_outline(image, outline_per_m, plot);
  DrawnPicture& picture = plot.picture;
  picture.width = std::min(image.columns, most_pixels);
  picture.height = pixel_rows(image);
  const auto& [first, last] = scale.range;
  for (const float value : values_of_pixels(image, picture.width, picture.height)) {
    if (!std::isfinite(value)) {
      picture.rgba.insert(picture.rgba.end(), 4, 0);
      continue;
    }
    const double share = std::clamp((value - first) / (last - first), 0.0, 1.0);
    const Rgb& colour = scale.colours[static_cast<std::size_t>(std::lround(share * (colour_count - 1)))];
    picture.rgba.insert(picture.rgba.end(), {colour[0], colour[1], colour[2], 255});
  }
  return map_figure(std::move(plot));
}

Drawing photograph_figure(const FluxImage& image, const std::vector<std::uint8_t>& rgb, int width, int height,
                          const std::string& title) {
  MapPlot plot = map_of(image, title);
  plot.picture.width = width;
  plot.picture.height = height;
  for (std::size_t n = 0; n + 2 < rgb.size(); n += 3)
    plot.picture.rgba.insert(plot.picture.rgba.end(), {rgb[n], rgb[n + 1], rgb[n + 2], 255});
  return map_figure(std::move(plot));
}

namespace {

/// Curve of a profile, through its levels or as stairs over its cells. @param metres of the unit of heights
PlotSeries curve_of(const FluxProfile& profile, double metres, const PlotColour& colour) {
  const bool of_cells = !profile.face_m.empty();
  const std::size_t count = profile.value.size();
  if (profile.height_m.size() != count || (of_cells && profile.face_m.size() != count + 1)) {
    throw InputError(fmt::format("{}: its profile is damaged (found {} values, allowed one per height: {})",
                                 profile.variable, count, profile.height_m.size()));
  }
  PlotSeries series{readable_name(profile.variable), {}, {}, {colour, 1.4}};
  const auto add = [&](double value, double height_m) {
    series.x.push_back(value);
    series.y.push_back(height_m / metres);
  };
  for (std::size_t k = 0; k < count; ++k) {
    add(profile.value[k], of_cells ? profile.face_m[k] : profile.height_m[k]);
    if (of_cells) add(profile.value[k], profile.face_m[k + 1]);
  }
  return series;
}

/// The range of the values with room at both sides: curves do not lie on the frame.
std::pair<double, double> range_with_margin(const LinePlot& plot) {
  constexpr double margin = 0.03;
  std::vector<double> values;
  for (const PlotSeries& series : plot.series) values.insert(values.end(), series.x.begin(), series.x.end());
  const auto [first, last] = axis_range(plot.x, values);
  return {first - margin * (last - first), last + margin * (last - first)};
}

}  // namespace

Drawing profile_figure(const std::vector<FluxProfile>& profiles, const std::string& title) {
  const FluxProfile& first = profiles.front();
  const LengthUnit unit = length_unit(first.top_m - first.bottom_m);
  LinePlot plot;
  plot.x = {.name = profiles.size() == 1 ? readable_name(first.variable) : "flux", .unit = first.units};
  plot.y = {.name = "z", .unit = unit.name};
  plot.y.range = std::pair(first.bottom_m / unit.metres, first.top_m / unit.metres);
  for (std::size_t n = 0; n < profiles.size(); ++n)
    plot.series.push_back(curve_of(profiles[n], unit.metres, plot_colour(n)));
  plot.x.range = range_with_margin(plot);
  constexpr double plot_height = 330, width = figure_width - 2 * figure_margin;
  Drawing drawing{.width = figure_width, .title = title};
  std::string subtitle = "domain mean";
  if (first.wavelength_um) subtitle += fmt::format(", {:g} \u00b5m", *first.wavelength_um);
  double top = figure_margin;
  top += draw_title(drawing, title, {figure_width / 2, top}, width);
  top += draw_title(drawing, subtitle, {figure_width / 2, top + 1}, width, figure_text_size);
  draw(drawing, {figure_margin, top, figure_width - figure_margin, top + plot_height}, plot);
  drawing.height = top + plot_height + figure_margin;
  if (profiles.size() > 1) {
    draw_legend(drawing, {4 * figure_margin, drawing.height}, width - 4 * figure_margin, plot.series);
    drawing.height += legend_height(width - 4 * figure_margin, plot.series) + figure_margin;
  }
  return drawing;
}

}  // namespace cloudbow
