#include "cloudbow/results/raster_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/rehearsal.hpp"
#include "hdf5_handle.hpp"

namespace cloudbow {
namespace {

using hdf5::check;
using hdf5::Handle;

constexpr std::size_t most_pixels = 100'000'000;

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& problem) {
  throw InputError(fmt::format("{}: {}", file.string(), problem));
}

void check_size(const std::filesystem::path& file, std::size_t nx, std::size_t ny) {
  if (nx == 0 || ny == 0 || nx > most_pixels / ny)
    fail(file, fmt::format("{} x {} values (allowed: 1 to {} in all)", nx, ny, most_pixels));
}

std::vector<hsize_t> shape_of(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), H5Sclose, "read a shape");
  std::vector<hsize_t> shape(static_cast<std::size_t>(check(H5Sget_simple_extent_ndims(space), "read a shape")));
  if (!shape.empty()) check(H5Sget_simple_extent_dims(space, shape.data(), nullptr), "read a shape");
  return shape;
}

bool is_plane_of_numbers(hid_t file, const std::string& name) {
  H5O_info_t info;
  check(H5Oget_info_by_name(file, name.c_str(), &info, H5P_DEFAULT), "look at an object");
  if (info.type != H5O_TYPE_DATASET) return false;
  const Handle dataset = hdf5::open_dataset(file, name.c_str());
  const Handle type(H5Dget_type(dataset), H5Tclose, "read a type");
  const H5T_class_t kind = H5Tget_class(type);
  return (kind == H5T_FLOAT || kind == H5T_INTEGER) && shape_of(dataset).size() == 2;
}

Raster read_hdf5(const std::filesystem::path& path, const char* wanted) {
  const Handle file = hdf5::open_file(path);
  std::vector<std::string> names;
  const auto take = [](hid_t, const char* name, const H5L_info_t*, void* result) -> herr_t {
    static_cast<std::vector<std::string>*>(result)->emplace_back(name);
    return 0;
  };
  check(H5Literate(file, H5_INDEX_NAME, H5_ITER_INC, nullptr, take, &names), "list a file");
  std::vector<std::string> planes;
  for (const std::string& name : names) {
    if (is_plane_of_numbers(file, name)) planes.push_back(name);
  }
  const bool named = std::find(planes.begin(), planes.end(), wanted) != planes.end();
  if (!named && planes.size() != 1) {
    fail(path,
         fmt::format("no dataset '{}' with two dimensions (found: {}; allowed: one of that name, or a single one)",
                     wanted, names.empty() ? "nothing" : fmt::format("{}", fmt::join(names, ", "))));
  }
  const Handle dataset = hdf5::open_dataset(file, named ? wanted : planes.front().c_str());
  const std::vector<hsize_t> shape = shape_of(dataset);
  check_size(path, shape[1], shape[0]);
  Raster raster{static_cast<int>(shape[1]), static_cast<int>(shape[0]), {}};
  raster.value.resize(shape[0] * shape[1]);
  check(H5Dread(dataset, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, raster.value.data()), "read a dataset");
  return raster;
}

Raster read_png(const std::filesystem::path& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&image, path.c_str()) == 0) fail(path, image.message);
  image.format = PNG_FORMAT_GRAY;
  try {
    check_size(path, image.width, image.height);
  } catch (...) {
    png_image_free(&image);
    throw;
  }
  std::vector<std::uint8_t> grey(PNG_IMAGE_SIZE(image));
  const png_color black{0, 0, 0};
  if (png_image_finish_read(&image, &black, grey.data(), 0, nullptr) == 0) fail(path, image.message);
  Raster raster{static_cast<int>(image.width), static_cast<int>(image.height), {}};
  raster.value.resize(grey.size());
  for (int j = 0; j < raster.ny; ++j) {
    const std::size_t line = static_cast<std::size_t>(raster.ny - 1 - j) * raster.nx;
    for (int i = 0; i < raster.nx; ++i)
      raster.value[static_cast<std::size_t>(j) * raster.nx + i] = static_cast<float>(grey[line + i]) / 255.F;
  }
  return raster;
}

// Shares of the old cells in each new one along an axis, and their sums of weights 1.
template <class Use>
void overlaps(int old_count, int new_count, Use&& use) {
  for (int to = 0; to < new_count; ++to) {
    const double low = static_cast<double>(to) * old_count / new_count;
    const double high = static_cast<double>(to + 1) * old_count / new_count;
    for (int from = static_cast<int>(low); from < old_count && from < high; ++from) {
      const double share = std::min<double>(from + 1, high) - std::max<double>(from, low);
      if (share > 0) use(from, to, share / (high - low));
    }
  }
}

}  // namespace

Raster read_raster(const std::filesystem::path& file, const char* name) {
  std::ifstream stream(file, std::ios::binary);
  std::array<unsigned char, 8> head{};
  if (!stream || std::filesystem::is_directory(file)) fail(file, "cannot be read");
  stream.read(reinterpret_cast<char*>(head.data()), head.size());
  if (png_sig_cmp(head.data(), 0, head.size()) == 0) return read_png(file);
  return after_rehearsal(file, {.library = "HDF5"}, [&] {
    try {
      return read_hdf5(file, name);
    } catch (const hdf5::Error& error) {
      fail(file, fmt::format("neither PNG nor HDF5 that can be read ({})", error.what()));
    }
  });
}

std::vector<float> area_means(const Raster& raster, int nx, int ny) {
  std::vector<double> wide(static_cast<std::size_t>(nx));  // one row of the raster in the columns of the means
  int row = -1;
  std::vector<double> sum(static_cast<std::size_t>(nx) * ny, 0.);
  overlaps(raster.ny, ny, [&](int from_row, int to_row, double share_of_row) {
    if (from_row != row) {
      row = from_row;
      std::fill(wide.begin(), wide.end(), 0.);
      const float* const value = raster.value.data() + static_cast<std::size_t>(row) * raster.nx;
      overlaps(raster.nx, nx,
               [&](int from, int to, double share) { wide[to] += share * static_cast<double>(value[from]); });
    }
    for (int i = 0; i < nx; ++i) sum[static_cast<std::size_t>(to_row) * nx + i] += share_of_row * wide[i];
  });
  return {sum.begin(), sum.end()};
}

}  // namespace cloudbow
