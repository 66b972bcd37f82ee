// One map or section out of a result file, as a picture needs it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cloudbow {

/// Extinction of the clouds in the cells of a section. Its columns are those of the image; its rows are the levels of
/// the grid.
struct SectionClouds {
  std::vector<float> extinction;   ///< [row][column] 1/m, row 0 at the bottom
  std::vector<double> row_edge_m;  ///< rows + 1, ascending
};

/// Values on a rectangle of cells, with the first axis to the right and the second upwards. It is a horizontal map (x,
/// y), the image of a camera or a vertical section (x or y, z). Without a choice, a section is that of a result with
/// one row or column of cells only.
struct FluxImage {
  std::string variable;
  std::string units;
  std::string long_name;    ///< as in the file; empty: none
  std::string scene_title;  ///< of the result; empty: none
  std::string place;  ///< "z = 3000 m" or empty for a map, "section x-z" for a section (of a result with several rows,
                      ///< "section x-z at y = 50 m"), "column", "camera"
  std::string columns_along = "x";  ///< axis to the right: x, y
  std::string rows_along = "y";     ///< axis upwards: y, z
  std::optional<double> wavelength_um;
  int columns = 0;
  int rows = 0;
  std::vector<float> value;               ///< [row][column], row 0 at the bottom; NaN: no value
  double column_start_m = 0;              ///< edge of the first column
  double column_width_m = 1;              ///< of a camera: 1, a pixel
  std::vector<double> row_edge_m;         ///< rows + 1, ascending
  std::vector<double> level_m{};          ///< heights of rows whose values hold at levels; empty: those of cells
  std::optional<SectionClouds> clouds{};  ///< of a section, if the result has the variable `extinction`
};

/// A vertical plane through a result.
struct SectionPlane {
  char axis = 'y';  ///< that it is perpendicular to: x or y
  double at_m = 0;  ///< along this axis; the nearest row or column of cells is taken
};

/// Indices of an image in a variable of more dimensions.
struct ImageChoice {
  /// "top", "bottom" or a height in metres between them, of which the nearest level is taken. Default: the top, of
  /// light that travels down the bottom. Sections and images refuse it.
  std::optional<std::string> level{};
  std::optional<double> wavelength_um;  ///< of which the nearest is taken; default: the first
  std::optional<SectionPlane> section{};
};

/// Domain means by height.
struct FluxProfile {
  std::string variable;
  std::string units;
  std::string long_name;
  std::string scene_title;
  std::optional<double> wavelength_um;
  std::vector<double> height_m, value;  ///< ascending; NaN: no value
  double bottom_m = 0, top_m = 0;       ///< of the domain
  std::vector<double> face_m{};         ///< of cells, one more than values; empty: the values hold at levels
};

/// Wavelengths [um] of a result; empty: it has no spectrum. @throws InputError if the file is no result.
std::vector<double> read_wavelengths(const std::filesystem::path& result_file);

/// Root variables that read_flux_image() can read, in the order of the file. @throws InputError as above.
std::vector<std::string> list_flux_images(const std::filesystem::path& result_file);

/// Reads a root variable of shape (y, x), (z, y, x) or (level, y, x); or an image with pixels of its own or of a
/// camera. All of them have the wavelength first if the result has a spectrum.
/// @throws InputError if the file is no result; if it lacks the variable (the message lists those in it), the level,
/// the section or any wavelength.
FluxImage read_flux_image(const std::filesystem::path& result_file, const std::string& variable,
                          const ImageChoice& choice);

/// Variables that read_flux_profile() can read: those of the group profile, then root variables with levels.
/// @throws InputError if the file is no result.
std::vector<std::string> list_flux_profiles(const std::filesystem::path& result_file);

/// Reads a variable of the group profile, or averages a root variable over its levels.
/// @throws InputError as read_flux_image()
FluxProfile read_flux_profile(const std::filesystem::path& result_file, const std::string& variable,
                              std::optional<double> wavelength_um);

}  // namespace cloudbow
