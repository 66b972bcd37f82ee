// Images in natural colours: reflectance factors at the wavelengths of the display's colours, through a tone curve.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cloudbow/io/flux_image.hpp"
#include "cloudbow/plots/render.hpp"

namespace cloudbow {

/// Images of the display's red, green and blue: three, or one for grey; and their description in words.
struct Channels {
  std::vector<FluxImage> image;
  std::string name;
};

/// Whether an option asks for a colormap or its ends.
bool uses_colormap(const RenderOptions& options);

/// Reflectance factors for a tone curve; none if the options or the file require a colormap.
/// @throws InputError for options that exclude each other or that the file has no image for
std::optional<Channels> find_channels(const RenderOptions& options);

/// The exposure asked for. @throws InputError if it is no number > 0
double exposure_of(const RenderOptions& options, const Channels& channels);

/// RGB of a picture, row by row from the top; black for pixels without value.
std::vector<std::uint8_t> natural_pixels(const Channels& channels, int width, int height, const std::string& tone,
                                         double exposure);

}  // namespace cloudbow
