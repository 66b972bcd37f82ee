#include "io/result_input.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cloudbow/core/error.hpp"
#include "cloudbow/sphere/interpolation_weights.hpp"
#include "io/open_result.hpp"

namespace cloudbow {

namespace {

using hdf5::check;
using hdf5::exists;
using hdf5::Handle;
using hdf5::shape_of;

constexpr hsize_t block_values = hsize_t{1} << 20;  // of float: what is read of the radiances at once, if chunks allow

/// Rows of a chunk; 1 if the variable has none.
hsize_t chunk_rows(hid_t dataset) {
  const Handle properties(H5Dget_create_plist(dataset), H5Pclose, "read a layout");
  hsize_t chunk[2] = {1, 1};
  if (H5Pget_layout(properties) == H5D_CHUNKED) check(H5Pget_chunk(properties, 2, chunk), "read a layout");
  return chunk[0];
}

}  // namespace

ResultInput::ResultInput(const std::filesystem::path& path) : path_(path.string()), file_(open_result(path)) {
  if (exists(file_, "wavelength"))
    fail("it holds a spectrum (found the dimension wavelength, allowed the result of a scene without [spectrum])");
  read_box();
}

void ResultInput::fail(const std::string& problem) const { throw InputError(fmt::format("{}: {}", path_, problem)); }

std::vector<double> ResultInput::coordinate(const char* name) const {
  if (!exists(file_, name)) fail(fmt::format("it is not a result file of cloudbow run (found no coordinate {})", name));
  const Handle dataset = hdf5::open_dataset(file_, name);
  const std::vector<hsize_t> shape = shape_of(dataset);
  if (shape.size() != 1 || shape[0] == 0 || shape[0] > std::numeric_limits<std::int32_t>::max()) {
    fail(fmt::format("coordinate {} is damaged (found the shape {}, allowed one dimension)", name, shape));
  }
  const std::vector<double> value = hdf5::read_all<double>(dataset);
  const auto bad = [](double a, double b) { return !(a < b); };
  if (std::adjacent_find(value.begin(), value.end(), bad) != value.end() || !std::isfinite(value.front()) ||
      !std::isfinite(value.back())) {
    fail(fmt::format("coordinate {} is damaged (allowed: finite, ascending)", name));
  }
  return value;
}

void ResultInput::read_box() {
  const std::vector<double> x = coordinate("x"), y = coordinate("y");
  box_.z_edge_m = coordinate("z_edge");
  if (box_.nz() < 1 || coordinate("z").size() + 1 != box_.z_edge_m.size()) {
    fail("coordinate z_edge is damaged (allowed: one height more than z has)");
  }
  const auto spacing = [this](const char* name) {
    const Handle dataset = hdf5::open_dataset(file_, name);
    if (!hdf5::has_attribute(dataset, "cell_size_m")) {
      fail(fmt::format("coordinate {} has no attribute cell_size_m (run the scene again with this cloudbow)", name));
    }
    const double size = hdf5::attribute_number(dataset, "cell_size_m");
    if (!(size > 0) || !std::isfinite(size)) {
      fail(fmt::format("coordinate {} is damaged (found cell_size_m = {}, allowed > 0)", name, size));
    }
    return size;
  };
  box_.nx = static_cast<int>(x.size());
  box_.ny = static_cast<int>(y.size());
  box_.dx_m = spacing("x");
  box_.dy_m = spacing("y");
  box_.x_min_m = x.front() - 0.5 * box_.dx_m;
  box_.y_min_m = y.front() - 0.5 * box_.dy_m;
  const Handle z = hdf5::open_dataset(file_, "z");
  if (!hdf5::has_attribute(z, "cloud_voxel_planes")) return;
  const double planes = hdf5::attribute_number(z, "cloud_voxel_planes");
  box_.cloud = {planes >= 1 && planes <= std::numeric_limits<std::int32_t>::max() ? static_cast<int>(planes) : 0,
                hdf5::attribute_number(z, "cloud_bottom_m"), hdf5::attribute_number(z, "cloud_voxel_height_m")};
  if (box_.cloud.count < 1 || !(box_.cloud.height_m > 0) || !std::isfinite(box_.cloud.height_m) ||
      !std::isfinite(box_.cloud.bottom_m)) {
    fail("coordinate z is damaged (allowed: cloud_voxel_planes >= 1 of cloud_voxel_height_m > 0)");
  }
}

std::vector<float> ResultInput::cell_field(const char* name, const char* field) const {
  if (!exists(file_, name)) {
    fail(fmt::format("it has no variable {} (run the scene with \"{}\" among output.fields)", name, field));
  }
  const Handle dataset = hdf5::open_dataset(file_, name);
  const std::vector<hsize_t> shape = shape_of(dataset);
  const std::vector<hsize_t> wanted = {static_cast<hsize_t>(box_.nz()), static_cast<hsize_t>(box_.ny),
                                       static_cast<hsize_t>(box_.nx)};
  if (shape != wanted) fail(fmt::format("{} is damaged (found the shape {}, allowed {})", name, shape, wanted));
  return hdf5::read_all<float>(dataset);
}

std::string ResultInput::units(const char* name, const char* otherwise) const {
  const Handle dataset = hdf5::open_dataset(file_, name);
  return hdf5::has_attribute(dataset, "units") ? hdf5::attribute_text(dataset, "units") : otherwise;
}

namespace {

Handle open_radiance(hid_t file, const std::string& path) {
  if (!exists(file, "radiance_field")) {
    throw InputError(fmt::format(
        "{}: it has no group radiance_field (run the scene with \"radiance_field\" among output.fields)", path));
  }
  for (const char* name : {"direction", "triangle", "voxel", "radiance"}) {
    if (!exists(file, fmt::format("radiance_field/{}", name).c_str())) {
      throw InputError(
          fmt::format("{}: radiance_field has no variable {} (run the scene again with this cloudbow)", path, name));
    }
  }
  return hdf5::open_dataset(file, "radiance_field/radiance");
}

}  // namespace

RadianceFieldInput::RadianceFieldInput(const ResultInput& result)
    : result_(result), dataset_(open_radiance(result.file_, result.path_)) {
  const auto rows_of = [&](const Handle& dataset, const char* name) {
    const std::vector<hsize_t> shape = shape_of(dataset);
    if (shape.size() != 2 || shape[1] != 3) {
      result_.fail(fmt::format("radiance_field/{} is damaged (found the shape {}, allowed n x 3)", name, shape));
    }
    return shape[0];
  };
  const auto read_triples = [&](const char* name, std::vector<std::array<std::int32_t, 3>>& triple,
                                const std::array<std::int32_t, 3>& end) {
    const Handle dataset = hdf5::open_dataset(result_.file_, fmt::format("radiance_field/{}", name).c_str());
    triple.resize(rows_of(dataset, name));
    const std::vector<std::int32_t> number = hdf5::read_all<std::int32_t>(dataset);
    for (std::size_t n = 0; n < triple.size(); ++n) {
      const auto& index = triple[n] = {number[3 * n], number[3 * n + 1], number[3 * n + 2]};
      for (int a = 0; a < 3; ++a) {
        if (index[a] < 0 || index[a] >= end[a]) {
          result_.fail(fmt::format("radiance_field/{} is damaged (found the index {}, allowed 0 to {})", name, index[a],
                                   end[a] - 1));
        }
      }
    }
  };

  const Handle direction = hdf5::open_dataset(result_.file_, "radiance_field/direction");
  rows_of(direction, "direction");
  const std::vector<double> number = hdf5::read_all<double>(direction);
  for (std::size_t n = 0; n < number.size(); n += 3) {
    direction_.emplace_back(number[n], number[n + 1], number[n + 2]);
    if (!(std::abs(direction_.back().norm() - 1) < 1e-6)) {
      result_.fail("radiance_field/direction is damaged (allowed: unit vectors)");
    }
  }
  const auto points = static_cast<std::int32_t>(direction_.size());
  read_triples("triangle", triangle_, {points, points, points});
  const BoxGrid& box = result_.box();
  read_triples("voxel", cell_, {box.nx, box.ny, box.nz()});
  const std::vector<hsize_t> wanted = {cell_.size(), direction_.size()};
  if (const std::vector<hsize_t> shape = shape_of(dataset_); shape != wanted) {
    result_.fail(fmt::format("radiance_field/radiance is damaged (found the shape {}, allowed {})", shape, wanted));
  }
  if (triangle_.empty()) result_.fail("radiance_field/triangle is empty (allowed: the triangles of the sphere)");
}

Stencil RadianceFieldInput::stencil(const Direction& unit) const {
  // The triangle of which no side lies to the left: on a side, the one that comes nearest to it.
  const std::array<std::int32_t, 3>* holder = &triangle_.front();
  double inside = -std::numeric_limits<double>::infinity();
  for (const auto& corner : triangle_) {
    const Direction &a = direction_[corner[0]], &b = direction_[corner[1]], &c = direction_[corner[2]];
    const double least = std::min({unit.dot(b.cross(c)), unit.dot(c.cross(a)), unit.dot(a.cross(b))});
    if (least > inside) {
      inside = least;
      holder = &corner;
    }
  }
  const auto& [a, b, c] = *holder;
  return {{a, b, c}, spherical_area_weights(unit, direction_[a], direction_[b], direction_[c])};
}

/// use(cell, radiances of the cell), block by block of cells: each chunk of the file is read once.
template <class Use>
void RadianceFieldInput::for_each_cell(Use use) const {
  const hsize_t points = direction_.size();
  const hsize_t chunk = chunk_rows(dataset_);
  const hsize_t most = std::max<hsize_t>(1, block_values / points / chunk) * chunk;
  std::vector<float> value;
  for (hsize_t begin = 0; begin < cell_.size(); begin += most) {
    const hdf5::Block block{{begin, 0}, {std::min<hsize_t>(most, cell_.size() - begin), points}};
    value.resize(block.values());
    hdf5::read_block(dataset_, block, H5T_NATIVE_FLOAT, value.data());
    for (hsize_t c = 0; c < block.size[0]; ++c) use(begin + c, value.data() + c * points);
  }
}

std::vector<float> RadianceFieldInput::radiance(const Stencil& stencil) const {
  std::vector<float> value(cell_.size());
  for_each_cell([&](std::size_t cell, const float* at_points) {
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += stencil.weight[c] * static_cast<double>(at_points[stencil.index[c]]);
    value[cell] = static_cast<float>(sum);
  });
  return value;
}

std::vector<float> RadianceFieldInput::radiances(std::size_t first, std::size_t count) const {
  const std::size_t n = cell_.size();
  std::vector<float> value(count * n);
  for_each_cell([&](std::size_t cell, const float* at_points) {
    for (std::size_t d = 0; d < count; ++d) value[d * n + cell] = at_points[first + d];
  });
  return value;
}

}  // namespace cloudbow
