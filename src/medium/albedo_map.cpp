#include "cloudbow/medium/albedo_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "albedo_map_readers.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/input_file.hpp"
#include "cloudbow/core/sandbox.hpp"
#include "cloudbow/medium/netcdf_library.hpp"

namespace cloudbow {
namespace {

const MapQuantity albedo_quantity{"albedo",
                                  {"albedo"},
                                  {"1, %",
                                   {{"", 1},
                                    {"1", 1},
                                    {"-", 1},
                                    {"none", 1},
                                    {"unitless", 1},
                                    {"fraction", 1},
                                    {"dimensionless", 1},
                                    {"%", 0.01},
                                    {"percent", 0.01},
                                    {"percentage", 0.01}}}};

constexpr double lowest_temperature_k = 100, highest_temperature_k = 1000;
const MapQuantity temperature_quantity{
    "temperature", {"surface_temperature", "temperature"}, {"K", {{"", 1}, {"k", 1}, {"kelvin", 1}}}};

/// Place of value n, in words.
std::string place_in(const GroundMap& map, std::size_t n) {
  const std::size_t nx = static_cast<std::size_t>(map.nx);
  return fmt::format("row {}, column {}, counted from the smallest y and x", n / nx, n % nx);
}

void check_temperatures(const std::filesystem::path& file, const GroundMap& map) {
  for (std::size_t n = 0; n < map.value.size(); ++n) {
    const float kelvin = map.value[n];
    if (kelvin >= lowest_temperature_k && kelvin <= highest_temperature_k) continue;
    if (std::isnan(kelvin))
      fail_import(file, "no value at {} (allowed: a temperature everywhere); fill the gaps", place_in(map, n));
    fail_import(file, "temperature out of range (found {} at {}, allowed {} to {} K, not Celsius)", kelvin,
                place_in(map, n), lowest_temperature_k, highest_temperature_k);
  }
}

void check_values(const std::filesystem::path& file, GroundMap& map) {
  constexpr float rounding = 1e-6F;  // of packed numbers
  for (std::size_t n = 0; n < map.value.size(); ++n) {
    float& albedo = map.value[n];
    if (albedo >= -rounding && albedo <= 1 + rounding) {
      albedo = std::clamp(albedo, 0.F, 1.F);
      continue;
    }
    const std::string place = place_in(map, n);
    if (std::isnan(albedo)) fail_import(file, "no value at {} (allowed: an albedo everywhere); fill the gaps", place);
    fail_import(
        file,
        "albedo out of range (found {} at {}, allowed 0 to 1); a file that holds per cent or packed numbers must "
        "say so by units = \"%\" or scale_factor",
        albedo, place);
  }
}

/// Shares of the old cells in each new one along an axis, and their sums of weights 1.
template <class Use>
void overlaps(int old_count, int new_count, Use&& use) {
  for (int to = 0; to < new_count; ++to) {
    const double low = static_cast<double>(to) * old_count / new_count;
    const double high = static_cast<double>(to + 1) * old_count / new_count;
    for (int from = static_cast<int>(low); from < old_count && from < high; ++from) {
      const double share = std::min<double>(from + 1, high) - std::max<double>(from, low);
      if (share > 0) use(static_cast<std::size_t>(from), static_cast<std::size_t>(to), share / (high - low));
    }
  }
}

}  // namespace

GroundMap read_albedo_map(const std::filesystem::path& file) {
  check_input(file, "a map of albedo as PNG or netCDF");
  const bool png = is_png(file);
  if (!png) netcdf_library();
  return after_sandbox(file, {.library = png ? "libpng" : "netCDF"}, [&] {
    GroundMap map = png ? read_png_map(file) : read_netcdf_map(file, albedo_quantity);
    check_values(file, map);
    return map;
  });
}

GroundMap read_temperature_map(const std::filesystem::path& file) {
  check_input(file, "a map of temperature as netCDF");
  if (is_png(file)) fail_import(file, "a picture (found PNG, allowed netCDF or HDF5) grey levels are no temperatures");
  netcdf_library();
  return after_sandbox(file, {.library = "netCDF"}, [&] {
    GroundMap map = read_netcdf_map(file, temperature_quantity);
    check_temperatures(file, map);
    return map;
  });
}

void check_covers(const GroundMap& map, const std::filesystem::path& file, const std::array<double, 2>& domain_m) {
  const std::array<int, 2> cells{map.nx, map.ny};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double slack = std::max(0.01, 1.0 / cells[axis]);
    if (!map.length_m[axis] || std::abs(*map.length_m[axis] / domain_m[axis] - 1) <= slack) continue;
    throw InputError(
        fmt::format("{}: not the size of the domain (found {:.6g} m along {} by its coordinates, allowed {:.6g} m, to "
                    "1 % or a cell); cut the map to the domain, or leave its coordinates out",
                    file.string(), *map.length_m[axis], axis == 0 ? "x" : "y", domain_m[axis]));
  }
}

std::vector<float> area_means(const GroundMap& map, int nx, int ny) {
  const auto width = static_cast<std::size_t>(nx);
  std::vector<double> sum(width * static_cast<std::size_t>(ny), 0.);
  // Rows come in their order, some twice in a row: one of them, brought to the new columns, is kept.
  std::vector<double> row(width);
  std::size_t row_from = static_cast<std::size_t>(map.ny);
  overlaps(map.ny, ny, [&](std::size_t from, std::size_t to, double share) {
    if (from != row_from) {
      row_from = from;
      std::fill(row.begin(), row.end(), 0.);
      const float* value = map.value.data() + from * static_cast<std::size_t>(map.nx);
      overlaps(map.nx, nx, [&](std::size_t i, std::size_t column, double part) {
        row[column] += part * static_cast<double>(value[i]);
      });
    }
    for (std::size_t i = 0; i < width; ++i) sum[to * width + i] += share * row[i];
  });
  return {sum.begin(), sum.end()};
}

}  // namespace cloudbow
