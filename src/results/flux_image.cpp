#include "cloudbow/results/flux_image.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>

#include "cloudbow/core/error.hpp"
#include "hdf5_handle.hpp"

namespace cloudbow {

namespace {

using hdf5::check;
using hdf5::Handle;

std::vector<hsize_t> shape_of(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), H5Sclose, "read a shape");
  std::vector<hsize_t> shape(static_cast<std::size_t>(check(H5Sget_simple_extent_ndims(space), "read a shape")));
  check(H5Sget_simple_extent_dims(space, shape.data(), nullptr), "read a shape");
  return shape;
}

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
  const Handle dataset = hdf5::open_dataset(file, name.c_str());
  const Handle space(H5Dget_space(dataset), H5Sclose, "read a coordinate");
  std::vector<double> value(static_cast<std::size_t>(check(H5Sget_simple_extent_npoints(space), "read a coordinate")));
  check(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, value.data()), "read a coordinate");
  return value;
}

std::string read_units(hid_t dataset) {
  const Handle attribute(H5Aopen(dataset, "units", H5P_DEFAULT), H5Aclose, "read units");
  const Handle type(H5Aget_type(attribute), H5Tclose, "read units");
  std::string text(H5Tget_size(type), '\0');
  check(H5Aread(attribute, type, text.data()), "read units");
  return text;
}

bool is_picture(hid_t file, const char* name) {
  H5O_info_t info;
  check(H5Oget_info_by_name(file, name, &info, H5P_DEFAULT), "look at an object");
  if (info.type != H5O_TYPE_DATASET) return false;
  const Handle dataset = hdf5::open_dataset(file, name);
  const auto rank = static_cast<unsigned>(shape_of(dataset).size());
  return (rank == 2 || rank == 3) && dimension_name(dataset, rank - 2) == "y" &&
         dimension_name(dataset, rank - 1) == "x";
}

/// The root variables with the dimensions y, x, in the order of the file.
std::vector<std::string> pictures(hid_t file) {
  std::vector<std::string> names;
  const auto take = [](hid_t, const char* name, const H5L_info_t*, void* result) -> herr_t {
    static_cast<std::vector<std::string>*>(result)->emplace_back(name);
    return 0;
  };
  check(H5Literate(file, H5_INDEX_CRT_ORDER, H5_ITER_INC, nullptr, take, &names), "list a file");
  std::erase_if(names, [file](const std::string& name) { return !is_picture(file, name.c_str()); });
  return names;
}

/// `count` layers of a (layer, y, x) variable from layer `first`, or all of a (y, x) variable.
std::vector<float> read_layers(hid_t dataset, const std::vector<hsize_t>& shape, hsize_t first, hsize_t count) {
  const Handle space(H5Dget_space(dataset), H5Sclose, "read a variable");
  std::vector<hsize_t> start(shape.size(), 0);
  std::vector<hsize_t> size = shape;
  if (shape.size() == 3) {
    start[0] = first;
    size[0] = count;
  }
  check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr),
        "choose a part of a variable");
  const Handle memory(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose,
                      "create a dataspace");
  std::vector<float> value(static_cast<std::size_t>(check(H5Sget_select_npoints(space), "read a variable")));
  check(H5Dread(dataset, H5T_NATIVE_FLOAT, memory, space, H5P_DEFAULT, value.data()), "read a variable");
  return value;
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

/// Distance between neighbouring cells; `other` where there is one cell only.
double spacing(const std::vector<double>& centre, double other) {
  return centre.size() > 1 ? centre[1] - centre[0] : other;
}

std::vector<double> edges_around(const std::vector<double>& centre, double width) {
  std::vector<double> edge;
  for (const double c : centre) edge.push_back(c - 0.5 * width);
  edge.push_back(centre.back() + 0.5 * width);
  return edge;
}

/// Each level stands for what is nearest to it, between the first and the last.
std::vector<double> edges_between(const std::vector<double>& level) {
  std::vector<double> edge = {level.front()};
  for (std::size_t k = 0; k + 1 < level.size(); ++k) edge.push_back(0.5 * (level[k] + level[k + 1]));
  edge.push_back(level.back());
  return edge;
}

FluxImage read_image(hid_t file, const std::string& where, const std::string& variable, const std::string& level) {
  const auto there = pictures(file);
  if (std::find(there.begin(), there.end(), variable) == there.end()) {
    throw InputError(fmt::format(
        "{}: there is no map \"{}\" to draw, the file has {}", where, variable,
        there.empty() ? std::string("none (is it a cloudbow result?)") : fmt::format("{}", fmt::join(there, ", "))));
  }
  const Handle dataset = hdf5::open_dataset(file, variable.c_str());
  const auto shape = shape_of(dataset);
  const auto x = read_coordinate(file, "x");
  const auto y = read_coordinate(file, "y");
  const double dx = spacing(x, spacing(y, 1));
  const double dy = spacing(y, dx);

  FluxImage image;
  image.variable = variable;
  image.units = read_units(dataset);
  const bool section = shape.size() == 3 && shape[0] > 1 && (x.size() == 1 || y.size() == 1);
  if (section) {
    // One of the two horizontal axes has length 1, so that [z][y][x] is [row][column] already.
    const std::string vertical = dimension_name(dataset, 0);
    image.place = x.size() > 1 ? "section x-z" : y.size() > 1 ? "section y-z" : "column";
    image.columns = static_cast<int>(std::max(x.size(), y.size()));
    image.rows = static_cast<int>(shape[0]);
    image.column_width_m = x.size() > 1 ? dx : dy;
    image.row_edge_m =
        vertical == "z" ? read_coordinate(file, "z_edge") : edges_between(read_coordinate(file, vertical));
    image.value = read_layers(dataset, shape, 0, shape[0]);
    return image;
  }
  hsize_t chosen = 0;
  if (shape.size() == 3) {
    const auto height = read_coordinate(file, dimension_name(dataset, 0));
    chosen = find_level(height, level, where);
    image.place = fmt::format("z = {:g} m", height[chosen]);
  }
  image.columns = static_cast<int>(x.size());
  image.rows = static_cast<int>(y.size());
  image.column_width_m = dx;
  image.row_edge_m = edges_around(y, dy);
  image.value = read_layers(dataset, shape, chosen, 1);
  return image;
}

}  // namespace

FluxImage read_flux_image(const std::filesystem::path& result_file, const std::string& variable,
                          const std::string& level) {
  const std::string where = result_file.string();
  std::error_code error;
  const auto status = std::filesystem::status(result_file, error);
  if (!std::filesystem::exists(status)) throw InputError(where + ": there is no such file");
  if (!std::filesystem::is_regular_file(status))
    throw InputError(where + ": it is not a file (name a result file of cloudbow run)");
  try {
    const Handle file = hdf5::open_file(result_file);
    return read_image(file, where, variable, level);
  } catch (const hdf5::Error& failure) {
    throw InputError(fmt::format("{}: can't be read as a result file of cloudbow run ({})", where, failure.what()));
  }
}

}  // namespace cloudbow
