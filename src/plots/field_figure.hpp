// Figures of fields: a map, a section or an image with axes in km or m and a scale of colours; domain means by height.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cloudbow/io/flux_image.hpp"
#include "plots/map_plot.hpp"

namespace cloudbow {

struct ColourChoice {
  std::string colormap{};                            ///< empty: by the values
  std::optional<std::pair<double, double>> range{};  ///< values of the first and last colour
  std::optional<double> min{}, max{};                ///< one of them; the other is that of the values
};

/// Values of the first and last colour: those chosen, or the smallest and largest value. Infinite if there is no value.
/// @throws InputError for a range that is none
std::pair<double, double> value_range(const std::vector<float>& values, const ColourChoice& choice);

/// Colours of a range of values. Without a choice: `diverging_colormap` for differences and for values on both sides of
/// 0 (the smaller side at least 1 % of the larger), else viridis. In a diverging map 0 has the middle colour, and equal
/// distances from 0 have equally strong colours; so the range takes a part of the map. A range of one value is widened.
ColourScale colour_scale(const std::string& variable, const std::string& unit, std::pair<double, double> range,
                         const ColourChoice& choice);

/// The name of a variable for readers: "upwelling flux"; of images their quantity.
std::string readable_name(const std::string& variable);

/// @param title plain text
/// @param outline_per_m extinction at which clouds have their outline in a section; 0: no outline
Drawing field_figure(const FluxImage& image, const ColourScale& scale, const std::string& title,
                     double outline_per_m = 0);
/// The same with a picture in colours of its own. @param rgb of width times height pixels
Drawing photograph_figure(const FluxImage& image, const std::vector<std::uint8_t>& rgb, int width, int height,
                          const std::string& title);

/// Values to the right, height upwards; all of one unit. Lines go through levels; cells are stairs from face to face.
/// One profile without legend, several with.
/// @throws InputError if a profile has not one value per height
Drawing profile_figure(const std::vector<FluxProfile>& profiles, const std::string& title);

}  // namespace cloudbow
