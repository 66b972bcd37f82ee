// Pictures of result files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cloudbow/io/flux_image.hpp"

namespace cloudbow {

/// Pixels alone, or a figure with axes, titles and a scale of colours. Without a choice: figures of maps and sections,
/// pixels of images of radiance and of cameras.
enum class RenderForm { automatic, bare, figure };

/// Thinner than clouds that are seen.
inline constexpr double outline_extinction_per_m = 1e-4;

struct RenderOptions {
  std::filesystem::path result_file;
  std::filesystem::path image_file;         ///< PNG, SVG or PDF, or OpenEXR if its name ends in .exr; no other ending
  std::string variable = "upwelling_flux";  ///< one of list_flux_images(), of profiles one of list_flux_profiles()
  RenderForm form = RenderForm::automatic;
  std::string section;   ///< "x=M" or "y=M": draw a vertical section there [m]; empty: none
  bool profile = false;  ///< draw domain means by height; of all fluxes if `all_fluxes`
  bool all_fluxes = false;
  std::optional<std::string> title{};   ///< of a figure; default: that of the scene
  int width = 0;                        ///< of a PNG figure in pixels; 0: 1200
  std::optional<std::string> level{};   ///< as in ImageChoice
  std::optional<double> wavelength_um;  ///< of a spectrum: draw the nearest alone
  std::optional<std::pair<double, double>>
      range;                           ///< values of the first and last colour; default: smallest and largest value
  std::optional<double> min{}, max{};  ///< one end of the range alone
  /// Extinction [1/m] at which figures of sections outline the clouds, if the result has the variable `extinction`; 0:
  /// no outline; default: outline_extinction_per_m.
  std::optional<double> outline{};
  int scale = 0;         ///< pixels per cell, nearest neighbour, of pixels alone, which it asks for; 0: so that the
                         ///< longer side is about 768 pixels, of cameras and of OpenEXR files 1
  std::string colormap;  ///< one of colormap_names(); empty: natural colours if possible; else grey, in figures
                         ///< viridis, or blue-red for differences and for values of both signs
  std::string tone;      ///< one of tone_names(); empty: filmic
  std::optional<double> exposure;  ///< factor on reflectance factors, > 0; default 1
  bool automatic_exposure = false;
};

/// Content of the picture, for a line on the terminal.
struct RenderReport {
  FluxImage image;  ///< of natural colours: the red one
  int width = 0;    ///< pixels, of SVG and PDF points
  int height = 0;
  std::string size_unit = "pixels";
  double min = 0;       ///< value of the first colour
  double max = 0;       ///< value of the last colour
  std::string colours;  ///< how values became colours
};

std::vector<std::string> colormap_names();
std::vector<std::string> tone_names();

/// Draws a map with x to the right and y up, or the image of a camera upright, atomically. A result with one row of
/// cells becomes a section with z up. One with a single cell becomes a curve by height.
///
/// Figures have axes in km, or in m if the domain is smaller than 2 km. Their title is that of the scene, with the long
/// name of the variable below it. A scale shows the colours with their unit.
///
/// Images of radiance at three wavelengths become natural colours. Red, green and blue are the reflectance factors at
/// the wavelengths nearest to 0.67, 0.55 and 0.45 um. They are multiplied by the exposure and pass through a tone curve
/// (docs/pictures.md). With a tone or an exposure, images of one wavelength become grey in the same way. All else is
/// drawn by a colormap, in which cells without value are transparent. OpenEXR files contain the numbers unchanged, 0
/// for cells without value.
/// @throws InputError for files that can't be read or written. Also for options out of range or that exclude each
/// other, with a list of the available or allowed ones.
RenderReport render(const RenderOptions& options);

}  // namespace cloudbow
