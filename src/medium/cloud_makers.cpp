#include "cloudbow/medium/cloud_makers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "cloud_maker_parts.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {

namespace {

constexpr double smallest_voxel_m3 = 3e-15;  // of an OpenVDB file
constexpr double largest_ratio = 500;        // of a cumulus' horizontal sides: turbulence as fine as the shorter one
constexpr double largest_field = 5e8;        // cells: the field is dense while it is made, 8 bytes per cell

template <class Number>
void require(bool holds, std::string_view key, const Number& found, std::string_view allowed) {
  if (!holds)
    throw InputError(fmt::format("cloud make: {} is out of range ({} found, {} allowed)", key, found, allowed));
}

bool is_random(const std::string& kind) { return kind == "cumulus" || kind == "stratocumulus"; }

void check(const CloudMakerOptions& options) {
  const auto& kinds = cloud_maker_kinds();
  if (std::find(kinds.begin(), kinds.end(), options.kind) == kinds.end()) {
    std::string allowed;
    for (const auto& kind : kinds) allowed += (allowed.empty() ? "" : ", ") + kind;
    throw InputError(fmt::format("cloud make: unknown kind (\"{}\" found, {} are allowed)", options.kind, allowed));
  }
  double cells = 1;
  for (const int n : options.cells) {
    require(n >= 1, "cells", n, "whole numbers >= 1 are");
    cells *= n;
  }
  require(cells <= largest_field, "cells", cells, fmt::format("up to {:g} in all are", largest_field));
  double volume = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double size = options.voxel_size_m[axis];
    require(std::isnormal(size) && size > 0 && std::isfinite(options.cells[axis] * size), "voxel-size-m", size,
            "numbers > 0 whose multiples are finite are");
    volume *= size;
  }
  require(volume >= smallest_voxel_m3, "voxel-size-m", fmt::format("{:g} m3", volume),
          fmt::format("voxels of {:g} m3 or more are", smallest_voxel_m3));
  if (options.optical_depth) {
    require(std::isfinite(*options.optical_depth) && *options.optical_depth > 0, "optical-depth",
            *options.optical_depth, "a finite number > 0 is");
  }

  const auto belongs = [&](bool given, std::string_view key, bool allowed) {
    if (given && !allowed)
      throw InputError(fmt::format("cloud make: {} does not belong to {} (leave it out)", key, options.kind));
  };
  belongs(options.cover.has_value(), "cover", is_random(options.kind));
  belongs(options.base_m.has_value(), "base-m", options.kind != "sphere");
  if (options.cover && options.kind == "cumulus") {
    require(*options.cover > 0 && *options.cover <= 0.8, "cover", *options.cover, "0 < cover <= 0.8 for cumulus is");
  } else if (options.cover) {
    require(*options.cover > 0 && *options.cover <= 1, "cover", *options.cover, "0 < cover <= 1 is");
  }
  if (options.base_m) {
    const double top = options.cells[2] * options.voxel_size_m[2];
    require(*options.base_m >= 0 && *options.base_m < top, "base-m", *options.base_m,
            fmt::format("0 <= base < {} m is", top));
  }

  const auto at_least = [&](int nx, int ny, int nz) {
    const auto& found = options.cells;
    require(found[0] >= nx && found[1] >= ny && found[2] >= nz, "cells",
            fmt::format("{} x {} x {}", found[0], found[1], found[2]),
            fmt::format("at least {} x {} x {} for {} are", nx, ny, nz, options.kind));
  };
  if (options.kind == "cumulus") {
    at_least(16, 16, 8);
    const double ratio = options.voxel_size_m[0] / options.voxel_size_m[1];
    require(ratio <= largest_ratio && ratio >= 1 / largest_ratio, "voxel-size-m",
            fmt::format("{:g} x {:g} m", options.voxel_size_m[0], options.voxel_size_m[1]),
            fmt::format("sides within a factor of {:g} for cumulus are", largest_ratio));
  }
  if (options.kind == "stratocumulus") at_least(8, 1, 4);
  if (options.kind == "sphere") at_least(4, 4, 4);
  if (options.kind == "step") {
    require(options.cells[0] % 2 == 0, "cells", options.cells[0], "an even number along x for step is");
  }
}

int base_level(const CloudMakerOptions& options) {
  const MakerGrid grid(options);
  const double base_m = options.base_m.value_or(is_random(options.kind) ? 0.4 * grid.height() : 0.0);
  return std::min(static_cast<int>(std::lround(base_m / grid.dz)), grid.nz - 1);
}

/// A slab whose left half has `left` times and whose right half has 2 - left times the optical depth.
DenseField make_slab(const MakerGrid& grid, int base, double optical_depth, double left) {
  DenseField field(grid.cells(), 0.0);
  const double extinction = optical_depth / ((grid.nz - base) * grid.dz);
  for (int k = base; k < grid.nz; ++k) {
    for (int j = 0; j < grid.ny; ++j) {
      for (int i = 0; i < grid.nx; ++i) field[grid.index(i, j, k)] = extinction * (2 * i < grid.nx ? left : 2 - left);
    }
  }
  return field;
}

DenseField make_sphere(const MakerGrid& grid, double optical_depth) {
  constexpr int samples = 8;  // along each edge of a cell: the share of a cell on the surface is known to about 1 %
  const double radius = 0.5 * std::min({grid.width_x() - grid.dx, grid.width_y() - grid.dy, grid.height() - grid.dz});
  const auto offset = [](int cell, int n, int sample, double size) {
    return (cell - 0.5 * n + (sample + 0.5) / samples) * size;
  };
  DenseField field(grid.cells(), 0.0);
  for (int k = 0; k < grid.nz; ++k) {
    for (int j = 0; j < grid.ny; ++j) {
      for (int i = 0; i < grid.nx; ++i) {
        int inside = 0;
        for (int n = 0; n < samples * samples * samples; ++n) {
          const double x = offset(i, grid.nx, n % samples, grid.dx);
          const double y = offset(j, grid.ny, n / samples % samples, grid.dy);
          const double z = offset(k, grid.nz, n / (samples * samples), grid.dz);
          inside += x * x + y * y + z * z <= radius * radius ? 1 : 0;
        }
        field[grid.index(i, j, k)] = optical_depth / (2 * radius) * inside / (samples * samples * samples);
      }
    }
  }
  return field;
}

/// Multiplies the field so that its columns with any cloud have the given mean optical depth.
void scale_to_optical_depth(DenseField& field, const MakerGrid& grid, double optical_depth) {
  std::vector<double> column(grid.columns(), 0.0);
  for (std::size_t n = 0; n < field.size(); ++n) column[n % column.size()] += field[n] * grid.dz;
  double sum = 0;
  std::size_t cloudy = 0;
  for (const double depth : column) {
    sum += depth;
    cloudy += depth > 0 ? 1 : 0;
  }
  const double factor = optical_depth * static_cast<double>(cloudy) / sum;
  for (double& extinction : field) extinction *= factor;
}

/// To 11 significant bits: differences between math libraries vanish, and files become half as large.
double round_value(double value) {
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return std::ldexp(std::nearbyint(std::ldexp(mantissa, 11)), exponent - 11);
}

}  // namespace

const std::vector<std::string>& cloud_maker_kinds() {
  static const std::vector<std::string> kinds = {"slab", "step", "sphere", "cumulus", "stratocumulus"};
  return kinds;
}

double value_exceeded_by(double fraction, std::vector<double> numbers) {
  const auto above = static_cast<std::size_t>(std::lround(fraction * static_cast<double>(numbers.size())));
  if (above >= numbers.size()) return -std::numeric_limits<double>::infinity();
  const auto place = numbers.end() - 1 - static_cast<std::ptrdiff_t>(above);
  std::nth_element(numbers.begin(), place, numbers.end());
  return *place;
}

CloudField make_cloud(const CloudMakerOptions& options) {
  check(options);
  const MakerGrid grid(options);
  const int base = base_level(options);
  DenseField field;
  if (options.kind == "slab") field = make_slab(grid, base, options.optical_depth.value_or(10), 1);
  if (options.kind == "step") field = make_slab(grid, base, options.optical_depth.value_or(10), 0.2);
  if (options.kind == "sphere") field = make_sphere(grid, options.optical_depth.value_or(20));
  if (options.kind == "cumulus") field = make_cumulus(grid, base, options.cover.value_or(0.2), options.seed);
  if (options.kind == "stratocumulus") field = make_stratocumulus(grid, base, options.cover.value_or(1), options.seed);
  if (is_random(options.kind)) {
    if (options.optical_depth) scale_to_optical_depth(field, grid, *options.optical_depth);
    std::transform(field.begin(), field.end(), field.begin(), round_value);
  }
  for (const double extinction : field) {
    require(extinction <= static_cast<double>(std::numeric_limits<float>::max()), "optical-depth", extinction,
            "extinctions that a 32-bit number holds, in 1/m, are");
  }
  CloudField cloud = make_cloud_field(options.cells, options.voxel_size_m, {0, 0, 0},
                                      std::vector<float>(field.begin(), field.end()), "extinction");
  if (cloud.value.empty()) {
    throw InputError(fmt::format(
        "cloud make: the {} is empty (found no cell with an extinction above 0 among {} x {} x {}) take another seed, "
        "more cells, more cover, a larger optical depth or smaller voxels",
        options.kind, options.cells[0], options.cells[1], options.cells[2]));
  }
  return cloud;
}

}  // namespace cloudbow
