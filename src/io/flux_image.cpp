#include "cloudbow/io/flux_image.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <string_view>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/sandbox.hpp"
#include "io/hdf5_handle.hpp"
#include "io/open_result.hpp"

namespace cloudbow {

namespace {

using hdf5::check;
using hdf5::Handle;
using hdf5::shape_of;

std::string dimension_name(hid_t dataset, unsigned axis) {
  std::string name;
  const auto take_name = [](hid_t, unsigned, hid_t scale, void* result) -> herr_t {
    char text[256] = "";
    if (H5DSget_scale_name(scale, text, sizeof text) < 0) return -1;
    *static_cast<std::string*>(result) = text;
    return 1;
  };
  check(H5DSiterate_scales(dataset, axis, nullptr, take_name, &name), "read a dimension scale");
  return name;
}

std::vector<double> read_coordinate(hid_t file, const std::string& name) {
  return hdf5::read_all<double>(hdf5::open_dataset(file, name.c_str()));
}

/// That of a dimension of this length.
std::vector<double> read_axis(hid_t file, const std::string& where, const std::string& name, hsize_t length) {
  std::vector<double> value = read_coordinate(file, name);
  if (value.empty() || value.size() != length) {
    throw InputError(fmt::format("{}: coordinate {} is damaged (found {} numbers, allowed {}, as its variables have)",
                                 where, name, value.size(), length));
  }
  return value;
}

/// Layout of an image in a variable's dimensions.
struct ImageShape {
  bool spectral = false;  ///< the first is the wavelength
  bool levels = false;    ///< then one of height
  bool camera = false;    ///< rows from the top, pixels
  std::string y, x;       ///< names of the last two
};

std::optional<ImageShape> image_shape(hid_t dataset) {
  const auto rank = static_cast<unsigned>(shape_of(dataset).size());
  if (rank < 2) return std::nullopt;
  ImageShape image;
  image.y = dimension_name(dataset, rank - 2);
  image.x = dimension_name(dataset, rank - 1);
  image.spectral = rank > 2 && dimension_name(dataset, 0) == "wavelength";
  const unsigned others = rank - 2 - (image.spectral ? 1 : 0);
  image.levels = others == 1;
  image.camera = image.y.starts_with("row_") && image.x.starts_with("column_");
  const bool map = image.y == "y" && image.x == "x";
  const bool pixels = image.y.starts_with("y_") && image.x.starts_with("x_");
  if (others > 1 || !(map || (others == 0 && (image.camera || pixels)))) return std::nullopt;
  return image;
}

bool is_image(hid_t file, const char* name) {
  H5O_info_t info;
  check(H5Oget_info_by_name(file, name, &info, H5P_DEFAULT), "look at an object");
  return info.type == H5O_TYPE_DATASET && image_shape(hdf5::open_dataset(file, name)).has_value();
}

std::vector<std::string> images(hid_t file) {
  std::vector<std::string> names = hdf5::member_names(file, H5_INDEX_CRT_ORDER);
  std::erase_if(names, [file](const std::string& name) { return !is_image(file, name.c_str()); });
  return names;
}

std::vector<double> wavelengths(hid_t file) {
  return hdf5::exists(file, "wavelength") ? read_coordinate(file, "wavelength") : std::vector<double>();
}

/// Whether a variable holds light that travels down, which is the same everywhere at the top, or nothing.
bool travels_down(const std::string& variable) {
  constexpr std::array<std::string_view, 4> names{"downwelling_diffuse_flux", "direct_flux", "direct_normal_flux",
                                                  "circumsolar_flux"};
  std::string_view name = variable;
  for (const std::string_view prefix : {"difference_", "independent_columns_"}) {
    if (name.starts_with(prefix)) name.remove_prefix(prefix.size());
  }
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::size_t find_level(const std::vector<double>& height, const std::string& level, const std::string& where) {
  if (level == "top") return height.size() - 1;
  if (level == "bottom") return 0;
  double wanted = 0;
  const auto [end, error] = std::from_chars(level.data(), level.data() + level.size(), wanted);
  // Between the first and last level a nearest one exists; the slack lets rounded heights of these two pass.
  const double slack = 1e-6 * (height.back() - height.front());
  if (error != std::errc() || end != level.data() + level.size() ||
      !(wanted >= height.front() - slack && wanted <= height.back() + slack)) {
    throw InputError(fmt::format("{}: level \"{}\" is not top, bottom or a height from {} to {} m", where, level,
                                 height.front(), height.back()));
  }
  const auto nearer = [wanted](double a, double b) { return std::abs(a - wanted) < std::abs(b - wanted); };
  return static_cast<std::size_t>(std::min_element(height.begin(), height.end(), nearer) - height.begin());
}

/// Distance between neighbouring cells; `other` if there is one cell only.
double spacing(const std::vector<double>& centre, double other) {
  return centre.size() > 1 ? centre[1] - centre[0] : other;
}

std::vector<double> edges_around(const std::vector<double>& centre, double width) {
  std::vector<double> edge;
  for (const double c : centre) edge.push_back(c - 0.5 * width);
  edge.push_back(centre.back() + 0.5 * width);
  return edge;
}

/// Each level represents the heights nearest to it, between the first and the last.
std::vector<double> edges_between(const std::vector<double>& level) {
  std::vector<double> edge = {level.front()};
  for (std::size_t k = 0; k + 1 < level.size(); ++k) edge.push_back(0.5 * (level[k] + level[k + 1]));
  edge.push_back(level.back());
  return edge;
}

std::vector<float> upside_down(const std::vector<float>& value, int rows, int columns) {
  std::vector<float> transposed;
  transposed.reserve(value.size());
  for (int row = rows - 1; row >= 0; --row) {
    const auto begin = value.begin() + static_cast<std::ptrdiff_t>(row) * columns;
    transposed.insert(transposed.end(), begin, begin + columns);
  }
  return transposed;
}

std::string text_or_nothing(hid_t object, const char* name) {
  return hdf5::has_attribute(object, name) ? hdf5::attribute_text(object, name) : "";
}

[[noreturn]] void throw_missing(const std::string& where, const std::string& kind, const std::string& variable,
                                const std::vector<std::string>& there) {
  throw InputError(fmt::format(
      "{}: there is no {} \"{}\" to draw, the file has {}", where, kind, variable,
      there.empty() ? std::string("none (is it a cloudbow result?)") : fmt::format("{}", fmt::join(there, ", "))));
}

/// A part of a variable that is read, along each dimension.
struct Selection {
  std::vector<hsize_t> size, start;
  std::optional<double> wavelength_um;
};

/// One wavelength, if the variable has any.
Selection select_wavelength(hid_t file, const std::string& where, const std::string& variable, hid_t dataset,
                            std::optional<double> wanted_um) {
  Selection selection{shape_of(dataset), {}, {}};
  selection.start.assign(selection.size.size(), 0);
  const bool spectral = selection.size.size() > 1 && dimension_name(dataset, 0) == "wavelength";
  if (wanted_um && !spectral) {
    throw InputError(fmt::format(
        "{}: --wavelength-um chooses among the wavelengths of a spectrum (found {} um, allowed none: {} has "
        "no axis of wavelengths)",
        where, *wanted_um, variable));
  }
  if (!spectral) return selection;
  const auto there_um = read_axis(file, where, "wavelength", selection.size[0]);
  const double wanted = wanted_um.value_or(there_um.front());
  const auto nearest = std::min_element(there_um.begin(), there_um.end(), [wanted](double a, double b) {
    return std::abs(a - wanted) < std::abs(b - wanted);
  });
  selection.wavelength_um = *nearest;
  selection.start[0] = static_cast<hsize_t>(nearest - there_um.begin());
  selection.size[0] = 1;
  return selection;
}

/// The row or column of cells nearest to a section. @param centre of the cells along its axis
std::size_t find_row(const std::vector<double>& centre, double width, const SectionPlane& section,
                     const std::string& where) {
  const double first = centre.front() - 0.5 * width, last = centre.back() + 0.5 * width;
  const double slack = 1e-6 * (last - first);
  if (!(section.at_m >= first - slack && section.at_m <= last + slack)) {
    throw InputError(fmt::format("{}: the section lies outside the domain (found {} = {} m, allowed {} to {} m)", where,
                                 section.axis, section.at_m, first, last));
  }
  const auto nearer = [&](double a, double b) { return std::abs(a - section.at_m) < std::abs(b - section.at_m); };
  return static_cast<std::size_t>(std::min_element(centre.begin(), centre.end(), nearer) - centre.begin());
}

/// Horizontal axes of a variable.
struct Horizontal {
  std::vector<double> x, y;
  double dx = 1, dy = 1;
};

/// @param selection of the variable of the section, which has the same columns
std::optional<SectionClouds> read_clouds(hid_t file, const std::string& where, const Selection& selection) {
  constexpr const char* name = "extinction";
  if (!hdf5::exists(file, name)) return std::nullopt;
  const Handle dataset = hdf5::open_dataset(file, name);
  const bool spectral = selection.wavelength_um.has_value();
  const std::size_t rank = spectral ? 4 : 3, vertical = spectral ? 1 : 0;
  Selection cells{shape_of(dataset), std::vector<hsize_t>(rank, 0), {}};
  if (cells.size.size() != rank) return std::nullopt;
  if (spectral) {
    cells.start[0] = selection.start[0];
    cells.size[0] = 1;
  }
  for (std::size_t n = 1; n <= 2; ++n) {
    cells.start[rank - n] = selection.start[selection.start.size() - n];
    cells.size[rank - n] = selection.size[selection.size.size() - n];
  }
  SectionClouds clouds{{}, read_axis(file, where, "z_edge", cells.size[vertical] + 1)};
  clouds.extinction = hdf5::read_block<float>(dataset, {cells.start, cells.size});
  return clouds;
}

/// @param choice with a section, or the variable has one row or column only
FluxImage read_section(hid_t file, const std::string& where, hid_t dataset, FluxImage image, Selection selection,
                       unsigned vertical, const Horizontal& axes, const ImageChoice& choice) {
  const std::size_t rank = selection.size.size();
  const std::string levels = dimension_name(dataset, vertical);
  image.rows = static_cast<int>(selection.size[vertical]);
  if (levels == "z") {
    image.row_edge_m = read_axis(file, where, "z_edge", selection.size[vertical] + 1);
  } else {
    image.level_m = read_axis(file, where, levels, selection.size[vertical]);
    image.row_edge_m = edges_between(image.level_m);
  }
  image.rows_along = "z";
  const bool along_x = choice.section ? choice.section->axis == 'y' : axes.x.size() > 1;
  if (choice.section) {
    const auto& centre = along_x ? axes.y : axes.x;
    const std::size_t row = find_row(centre, along_x ? axes.dy : axes.dx, *choice.section, where);
    const std::size_t axis = along_x ? rank - 2 : rank - 1;
    selection.start[axis] = row;
    selection.size[axis] = 1;
    image.place = fmt::format("section {} at {} = {:g} m", along_x ? "x-z" : "y-z", choice.section->axis, centre[row]);
  } else {
    image.place = axes.x.size() > 1 ? "section x-z" : axes.y.size() > 1 ? "section y-z" : "column";
  }
  image.columns_along = along_x ? "x" : "y";
  const auto& centre = along_x ? axes.x : axes.y;
  image.columns = static_cast<int>(centre.size());
  image.column_width_m = along_x ? axes.dx : axes.dy;
  image.column_start_m = centre.front() - 0.5 * image.column_width_m;
  // One of the two horizontal axes has length 1, so that [z][y][x] is [row][column] already.
  image.value = hdf5::read_block<float>(dataset, {selection.start, selection.size});
  image.clouds = read_clouds(file, where, selection);
  return image;
}

FluxImage read_image(hid_t file, const std::string& where, const std::string& variable, const ImageChoice& choice) {
  const auto there = images(file);
  if (std::find(there.begin(), there.end(), variable) == there.end()) throw_missing(where, "map", variable, there);
  const Handle dataset = hdf5::open_dataset(file, variable.c_str());
  const ImageShape kind = *image_shape(dataset);
  FluxImage image;
  image.variable = variable;
  image.units = hdf5::attribute_text(dataset, "units");
  image.long_name = text_or_nothing(dataset, "long_name");
  image.scene_title = text_or_nothing(file, "title");
  Selection selection = select_wavelength(file, where, variable, dataset, choice.wavelength_um);
  image.wavelength_um = selection.wavelength_um;
  auto& [size, start, wavelength_um] = selection;
  Horizontal axes{read_axis(file, where, kind.x, size[size.size() - 1]),
                  read_axis(file, where, kind.y, size[size.size() - 2])};
  axes.dx = spacing(axes.x, spacing(axes.y, 1));
  axes.dy = spacing(axes.y, axes.dx);

  const unsigned vertical = kind.spectral ? 1 : 0;
  const bool has_levels = kind.levels && size[vertical] > 1;
  if (choice.section && !has_levels) {
    throw InputError(
        fmt::format("{}: a section needs a variable with several levels (found {}, allowed those along z, "
                    "z_edge or z_flux)",
                    where, variable));
  }
  const bool is_section = choice.section || (has_levels && (axes.x.size() == 1 || axes.y.size() == 1));
  if ((is_section || !kind.levels) && choice.level) {
    throw InputError(fmt::format("{}: level {} has no effect (found {}, {}; leave the level out)", where, *choice.level,
                                 variable, is_section ? "a section of all levels" : "which has no levels"));
  }
  if (is_section)
    return read_section(file, where, dataset, std::move(image), std::move(selection), vertical, axes, choice);
  if (kind.levels) {
    const auto height = read_axis(file, where, dimension_name(dataset, vertical), size[vertical]);
    const std::string level = choice.level.value_or(travels_down(variable) ? "bottom" : "top");
    start[vertical] = find_level(height, level, where);
    size[vertical] = 1;
    image.place = fmt::format("z = {:g} m", height[start[vertical]]);
  }
  image.columns = static_cast<int>(axes.x.size());
  image.rows = static_cast<int>(axes.y.size());
  image.value = hdf5::read_block<float>(dataset, {start, size});
  if (kind.camera) {
    image.place = "camera";
    image.value = upside_down(image.value, image.rows, image.columns);
    image.row_edge_m.resize(axes.y.size() + 1);
    std::iota(image.row_edge_m.begin(), image.row_edge_m.end(), 0.0);
  } else {
    image.column_width_m = axes.dx;
    image.column_start_m = axes.x.front() - 0.5 * axes.dx;
    image.row_edge_m = edges_around(axes.y, axes.dy);
  }
  return image;
}

constexpr const char* profile_group = "profile";

bool is_profile(hid_t group, const std::string& name) {
  return name != "z" && name != "z_edge" && name != "wavelength" &&
         !shape_of(hdf5::open_dataset(group, name.c_str())).empty();
}

std::vector<std::string> profiles(hid_t file) {
  std::vector<std::string> names;
  if (hdf5::exists(file, profile_group)) {
    const Handle group = hdf5::open_group(file, profile_group);
    names = hdf5::member_names(group, H5_INDEX_NAME);
    std::erase_if(names, [&group](const std::string& name) { return !is_profile(group, name); });
  }
  for (const std::string& name : images(file)) {
    const auto kind = image_shape(hdf5::open_dataset(file, name.c_str()));
    if (kind->levels && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

/// Means over the values of each level.
std::vector<double> level_means(const std::vector<float>& value, std::size_t levels) {
  const std::size_t count = value.size() / levels;
  std::vector<double> mean;
  for (std::size_t level = 0; level < levels; ++level) {
    double sum = 0;
    for (std::size_t n = 0; n < count; ++n) sum += value[level * count + n];
    mean.push_back(sum / static_cast<double>(count));
  }
  return mean;
}

FluxProfile read_profile(hid_t file, const std::string& where, const std::string& variable,
                         std::optional<double> wavelength_um) {
  const auto there = profiles(file);
  if (std::find(there.begin(), there.end(), variable) == there.end()) throw_missing(where, "profile", variable, there);
  std::optional<Handle> group;
  if (hdf5::exists(file, profile_group)) group.emplace(hdf5::open_group(file, profile_group));
  const bool stored = group && hdf5::exists(*group, variable.c_str());
  const Handle dataset = hdf5::open_dataset(stored ? static_cast<hid_t>(*group) : file, variable.c_str());
  const Selection selection = select_wavelength(file, where, variable, dataset, wavelength_um);
  const unsigned vertical = selection.wavelength_um ? 1 : 0;
  if (selection.size.size() <= vertical)
    throw InputError(fmt::format("{}: {} has no levels (found one value, allowed one per level)", where, variable));
  const std::size_t levels = selection.size[vertical];
  FluxProfile profile{variable,
                      hdf5::attribute_text(dataset, "units"),
                      text_or_nothing(dataset, "long_name"),
                      text_or_nothing(file, "title"),
                      selection.wavelength_um,
                      read_axis(file, where, dimension_name(dataset, vertical), levels),
                      {},
                      0,
                      0,
                      {}};
  if (dimension_name(dataset, vertical) == "z") profile.face_m = read_axis(file, where, "z_edge", levels + 1);
  const std::vector<double> edge = read_coordinate(file, "z_edge");
  profile.bottom_m = edge.empty() ? profile.height_m.front() : edge.front();
  profile.top_m = edge.empty() ? profile.height_m.back() : edge.back();
  if (stored) {
    profile.value = hdf5::read_block<double>(dataset, {selection.start, selection.size});
  } else {
    profile.value = level_means(hdf5::read_block<float>(dataset, {selection.start, selection.size}), levels);
  }
  return profile;
}

/// Does something with an open result file.
template <class Action>
auto with_result(const std::filesystem::path& result_file, const Action& action) {
  const std::string where = result_file.string();
  return after_sandbox(result_file, {.library = "HDF5"}, [&] {
    try {
      const Handle file = open_result(result_file);
      return action(file);
    } catch (const hdf5::Error& failure) {
      throw InputError(fmt::format("{}: can't be read as a result file of cloudbow run ({})", where, failure.what()));
    }
  });
}

}  // namespace

std::vector<double> read_wavelengths(const std::filesystem::path& result_file) {
  return with_result(result_file, [](hid_t file) { return wavelengths(file); });
}

std::vector<std::string> list_flux_images(const std::filesystem::path& result_file) {
  return with_result(result_file, [](hid_t file) { return images(file); });
}

FluxImage read_flux_image(const std::filesystem::path& result_file, const std::string& variable,
                          const ImageChoice& choice) {
  return with_result(result_file, [&](hid_t file) { return read_image(file, result_file.string(), variable, choice); });
}

std::vector<std::string> list_flux_profiles(const std::filesystem::path& result_file) {
  return with_result(result_file, [](hid_t file) { return profiles(file); });
}

FluxProfile read_flux_profile(const std::filesystem::path& result_file, const std::string& variable,
                              std::optional<double> wavelength_um) {
  return with_result(result_file,
                     [&](hid_t file) { return read_profile(file, result_file.string(), variable, wavelength_um); });
}

}  // namespace cloudbow
