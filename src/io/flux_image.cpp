#include "cloudbow/io/flux_image.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/sandbox.hpp"
#include "io/hdf5_handle.hpp"

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

FluxImage read_image(hid_t file, const std::string& where, const std::string& variable, const ImageChoice& choice) {
  const auto there = images(file);
  if (std::find(there.begin(), there.end(), variable) == there.end()) {
    throw InputError(fmt::format(
        "{}: there is no map \"{}\" to draw, the file has {}", where, variable,
        there.empty() ? std::string("none (is it a cloudbow result?)") : fmt::format("{}", fmt::join(there, ", "))));
  }
  const Handle dataset = hdf5::open_dataset(file, variable.c_str());
  const ImageShape kind = *image_shape(dataset);
  std::vector<hsize_t> size = shape_of(dataset);
  const auto x = read_axis(file, where, kind.x, size[size.size() - 1]);
  const auto y = read_axis(file, where, kind.y, size[size.size() - 2]);
  const double dx = spacing(x, spacing(y, 1));
  const double dy = spacing(y, dx);

  FluxImage image;
  image.variable = variable;
  image.units = hdf5::attribute_text(dataset, "units");
  std::vector<hsize_t> start(size.size(), 0);
  if (choice.wavelength_um && !kind.spectral) {
    throw InputError(fmt::format(
        "{}: --wavelength-um chooses among the wavelengths of a spectrum (found {} um, allowed none: {} has "
        "no axis of wavelengths)",
        where, *choice.wavelength_um, variable));
  }
  if (kind.spectral) {
    const auto there_um = read_axis(file, where, "wavelength", size[0]);
    const double wanted = choice.wavelength_um.value_or(there_um.front());
    const auto nearest = std::min_element(there_um.begin(), there_um.end(), [wanted](double a, double b) {
      return std::abs(a - wanted) < std::abs(b - wanted);
    });
    image.wavelength_um = *nearest;
    start[0] = static_cast<hsize_t>(nearest - there_um.begin());
    size[0] = 1;
  }
  const unsigned vertical = kind.spectral ? 1 : 0;
  if (kind.levels && size[vertical] > 1 && (x.size() == 1 || y.size() == 1)) {
    // One of the two horizontal axes has length 1, so that [z][y][x] is [row][column] already.
    const std::string name = dimension_name(dataset, vertical);
    image.place = x.size() > 1 ? "section x-z" : y.size() > 1 ? "section y-z" : "column";
    image.columns = static_cast<int>(std::max(x.size(), y.size()));
    image.rows = static_cast<int>(size[vertical]);
    image.column_width_m = x.size() > 1 ? dx : dy;
    image.row_edge_m = name == "z" ? read_axis(file, where, "z_edge", size[vertical] + 1)
                                   : edges_between(read_axis(file, where, name, size[vertical]));
    image.value = hdf5::read_block<float>(dataset, {start, size});
    return image;
  }
  if (kind.levels) {
    const auto height = read_axis(file, where, dimension_name(dataset, vertical), size[vertical]);
    start[vertical] = find_level(height, choice.level, where);
    size[vertical] = 1;
    image.place = fmt::format("z = {:g} m", height[start[vertical]]);
  }
  image.columns = static_cast<int>(x.size());
  image.rows = static_cast<int>(y.size());
  image.value = hdf5::read_block<float>(dataset, {start, size});
  if (kind.camera) {
    image.place = "camera";
    image.value = upside_down(image.value, image.rows, image.columns);
    image.row_edge_m.resize(y.size() + 1);
    std::iota(image.row_edge_m.begin(), image.row_edge_m.end(), 0.0);
  } else {
    image.column_width_m = dx;
    image.row_edge_m = edges_around(y, dy);
  }
  return image;
}

/// Does something with an open result file.
template <class Action>
auto with_result(const std::filesystem::path& result_file, const Action& action) {
  const std::string where = result_file.string();
  return after_sandbox(result_file, {.library = "HDF5"}, [&] {
    try {
      const Handle file = hdf5::open_file(result_file);
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

}  // namespace cloudbow
