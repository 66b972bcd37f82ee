// Solutions filled by hand: every number encodes its own location, so that a swapped axis or a wrong offset shows.
#pragma once

#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "cloudbow/io/result_file.hpp"
#include "cloudbow/sphere/control_points.hpp"

namespace cloudbow::sample {

inline float field_value(int variable, int k, int j, int i) {
  return static_cast<float>(1000 * variable + 100 * k + 10 * j) + static_cast<float>(i) / 16;
}

inline std::vector<float> field(int variable, const std::vector<int>& level, int ny, int nx) {
  std::vector<float> value;
  for (const int k : level) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) value.push_back(field_value(variable, k, j, i));
    }
  }
  return value;
}

inline std::vector<double> profile(int variable, int levels) {
  std::vector<double> value;
  for (int k = 0; k < levels; ++k) value.push_back(variable + 0.125 * k);
  return value;
}

inline std::vector<int> count(int n) {
  std::vector<int> index(static_cast<std::size_t>(n));
  std::iota(index.begin(), index.end(), 0);
  return index;
}

/// Cells of 25 x 50 m from the corner (100, -50); interfaces at 500 m + 10, 30, 60, 100 ... m. Fluxes at `flux_level`,
/// empty: at all.
inline Solution solution(int nx, int ny, int nz, std::vector<int> flux_level = {}) {
  Solution s;
  s.box.nx = nx;
  s.box.ny = ny;
  s.box.dx_m = 25;
  s.box.dy_m = 50;
  s.box.x_min_m = 100;
  s.box.y_min_m = -50;
  for (int k = 0; k <= nz; ++k) s.box.z_edge_m.push_back(500 + 5 * (k + 1) * (k + 2));
  s.flux_level = flux_level.empty() ? count(nz + 1) : std::move(flux_level);
  s.upwelling_flux = field(1, s.flux_level, ny, nx);
  s.downwelling_diffuse_flux = field(2, s.flux_level, ny, nx);
  s.direct_flux = field(3, s.flux_level, ny, nx);
  s.profile_upwelling_flux = profile(1, nz + 1);
  s.profile_downwelling_diffuse_flux = profile(2, nz + 1);
  s.profile_direct_flux = profile(3, nz + 1);
  s.absorbed_power = field(4, count(nz), ny, nx);
  s.actinic_flux = field(5, count(nz), ny, nx);
  s.actinic_flux.front() = std::numeric_limits<float>::quiet_NaN();
  s.ledger = {.power = 8,
              .reflectance = 0.5,
              .transmittance = 0.375,
              .transmittance_direct = 0.125,
              .absorptance = 0.0625,
              .surface_absorptance = 0.03125,
              .side_gain = 0.25,
              .side_loss = 0.28125,
              .residual = 1e-7};
  s.report = {.converged = true,
              .sweeps = 17,
              .estimated_error = 5e-5,
              .gather_rescaling = 1.001,
              .control_points = 162,
              .directions = "double-gauss-8x16",
              .mode = "3d",
              .collapsed_axes = "x",
              .added_levels = 3,
              .radiance_storage = "float32",
              .active_voxels = 5'000'000'000,
              .threads = 2,
              .seconds_total = 12.5,
              .seconds_tables = 0.5,
              .seconds_beam = 0.25,
              .seconds_sweeps = 10,
              .seconds_scattering = 4,
              .seconds_acceleration = 0.125,
              .seconds_gather = 1.5,
              .cpu_seconds = 24,
              .peak_memory_bytes = 6'000'000'000,
              .fit_closure = 1e-12,
              .fit_max_error = 0.01,
              .fit_fallbacks = 0};
  return s;
}

/// Of a scene that emits, without sun.
inline Solution thermal_solution(int nx, int ny, int nz) {
  Solution s = solution(nx, ny, nz);
  s.emits = true;
  s.ledger.incident = .25;
  s.ledger.surface_emission = .75;
  return s;
}

/// Two voxels, three control points, which are no more than one triangle.
inline RadianceField radiance_field() {
  return {{Direction(0, 0, -1), Direction(1, 0, 0), Direction(0, 0.6, 0.8)},
          {{0, 1, 2}},
          {{1, 2, 3}, {4, 5, 6}},
          {0, 1, 2, 10, 11, 12}};
}

/// Smooth radiances > 0 with the sum of the cell's indices in them, at the control points.
inline RadianceField radiance_field(const ControlPoints& points, std::vector<std::array<std::int32_t, 3>> cells) {
  RadianceField field;
  field.direction.assign(points.directions().begin(), points.directions().end());
  field.triangle.assign(points.triangles().begin(), points.triangles().end());
  field.voxel = std::move(cells);
  for (const auto& [i, j, k] : field.voxel) {
    for (const Direction& d : field.direction) {
      field.radiance.push_back(static_cast<float>(2 + i + 10 * j + 100 * k + d.x() - 0.5 * d.y() * d.z()));
    }
  }
  return field;
}

/// Directions that lie all over the sphere: a spiral.
inline std::vector<Direction> directions() {
  std::vector<Direction> direction;
  for (int n = 0; n < 100; ++n) {
    const double z = -0.99 + 0.0198 * n;
    const double azimuth = 2.4 * n;
    const double across = std::sqrt(1 - z * z);
    direction.emplace_back(across * std::cos(azimuth), across * std::sin(azimuth), z);
  }
  return direction;
}

/// Value that the library interpolates for a cell.
inline double queried(const ControlPoints& points, const RadianceField& field, std::size_t cell,
                      const Direction& travel) {
  const Stencil stencil = points.stencil(travel);
  double sum = 0;
  for (int c = 0; c < 3; ++c) {
    sum +=
        stencil.weight[c] *
        static_cast<double>(field.radiance[cell * field.direction.size() + static_cast<std::size_t>(stencil.index[c])]);
  }
  return sum;
}

inline ResultInfo info() {
  return {"Wolken über Köln", "cloudbow 0.1.0", "2026-01-02T03:04:05Z cloudbow run a.toml",
          "[sun]\nzenith_deg = 60.0\n"};
}

}  // namespace cloudbow::sample
