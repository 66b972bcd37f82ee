// Small boxes and fields for the tests of transport.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "cloudbow/medium/optical_grid.hpp"
#include "cloudbow/sphere/direction.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Levels of 1 m unless `z_edge_m` is given.
inline BoxGrid make_box(int nx, int ny, int nz, bool periodic = true) {
  BoxGrid box;
  box.nx = nx;
  box.ny = ny;
  box.periodic = periodic;
  for (int k = 0; k <= nz; ++k) box.z_edge_m.push_back(k);
  return box;
}

/// Grid of dense coefficients at (k*ny + j)*nx + i; cells without extinction are empty. No layers.
inline OpticalGrid make_grid(const BoxGrid& box, const std::vector<float>& absorption,
                             const std::vector<std::vector<float>>& scattering) {
  OpticalGrid grid;
  grid.box = box;
  grid.scattering.resize(scattering.size());
  grid.layer_absorption.assign(static_cast<std::size_t>(box.nz()), 0.);
  grid.layer_scattering.assign(scattering.size(), grid.layer_absorption);
  for (int row = 0; row < box.nz() * box.ny; ++row) {
    grid.row_begin.push_back(static_cast<std::uint32_t>(grid.spans.size()));
    bool in_span = false;
    for (int i = 0; i < box.nx; ++i) {
      const std::size_t c =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(box.nx) + static_cast<std::size_t>(i);
      float extinction = absorption[c];
      for (const auto& s : scattering) extinction += s[c];
      if (extinction > 0) {
        if (!in_span) grid.spans.push_back({i, 0, static_cast<std::uint32_t>(grid.absorption.size())});
        ++grid.spans.back().n;
        grid.absorption.push_back(absorption[c]);
        for (std::size_t p = 0; p < scattering.size(); ++p) grid.scattering[p].push_back(scattering[p][c]);
      }
      in_span = extinction > 0;
    }
  }
  grid.row_begin.push_back(static_cast<std::uint32_t>(grid.spans.size()));
  return grid;
}

inline std::size_t cells_of(const BoxGrid& box) { return box.columns() * static_cast<std::size_t>(box.nz()); }

/// The same numbers everywhere: mt19937's output is fixed by the standard, distributions are not.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()() { return static_cast<double>(engine_()) / 4294967296.; }

 private:
  std::mt19937 engine_;
};

/// Extinction between 0 and `largest`, a third of the cells empty unless `full`.
inline std::vector<float> random_extinction(const BoxGrid& box, double largest, unsigned seed, bool full = false) {
  Random random(seed);
  std::vector<float> extinction(cells_of(box));
  for (float& e : extinction) {
    const bool empty = random() < 1. / 3 && !full;
    const double value = largest * random();
    e = empty ? 0.F : static_cast<float>(value);
  }
  return extinction;
}

/// Grid of one phase function with the same single-scattering albedo everywhere.
inline OpticalGrid make_grid(const BoxGrid& box, const std::vector<float>& extinction,
                             double single_scattering_albedo) {
  std::vector<float> absorption, scattering;
  for (const float e : extinction) {
    absorption.push_back(static_cast<float>((1 - single_scattering_albedo) * static_cast<double>(e)));
    scattering.push_back(static_cast<float>(single_scattering_albedo * static_cast<double>(e)));
  }
  return make_grid(box, absorption, {scattering});
}

/// Travel along a vertical cosine (negative: down) and an azimuth counted from x towards y.
inline Direction travel_along(double mu, double azimuth_deg) {
  const double sine = std::sqrt(1 - mu * mu);
  const double azimuth = azimuth_deg * std::numbers::pi / 180;
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), mu};
}

/// Few directions of everything, so that dozens of problems take seconds: for properties that hold at any accuracy.
/// Layers of two kinds: absorbing and scattering, 1/m, by level.
struct Layers {
  std::vector<double> absorption, scattering;
};

/// Voxels of a cloud, and the layers around them in blocks of so many columns; 0: one block for each level.
/// @param cloud extinction of the dense box; its single-scattering albedo is 1.
inline OpticalGrid grid_in_blocks(const BoxGrid& box, const std::vector<float>& cloud, const Layers& layers,
                                  int columns) {
  OpticalGrid grid;
  grid.box = box;
  grid.layer_absorption = layers.absorption;
  grid.layer_scattering = {std::vector<double>(layers.absorption.size(), 0.), layers.scattering};
  grid.scattering.resize(2);
  grid.row_begin.push_back(0);
  const auto add_cell = [&](int k, double extinction) {
    grid.absorption.push_back(static_cast<float>(layers.absorption[k]));
    grid.scattering[0].push_back(static_cast<float>(extinction));
    grid.scattering[1].push_back(static_cast<float>(layers.scattering[k]));
  };
  for (int k = 0; k < box.nz(); ++k) {
    for (int j = 0; j < box.ny; ++j) {
      for (int i = 0; i < box.nx; ++i) {
        const double here = cloud[(static_cast<std::size_t>(k) * box.ny + j) * box.nx + i];
        if (here <= 0) continue;
        const bool extends =
            grid.spans.size() > grid.row_begin.back() && grid.spans.back().i + grid.spans.back().n == i;
        if (!extends) grid.spans.push_back({i, 0, static_cast<std::uint32_t>(grid.absorption.size())});
        ++grid.spans.back().n;
        add_cell(k, here);
      }
      grid.row_begin.push_back(static_cast<std::uint32_t>(grid.spans.size()));
    }
    AirBlocks air;
    if (layers.absorption[k] + layers.scattering[k] > 0) {
      air.first_cell = static_cast<std::uint32_t>(grid.absorption.size());
      air.width_x = columns > 0 ? columns : box.nx;
      air.width_y = columns > 0 ? columns : box.ny;
      air.x = (box.nx + air.width_x - 1) / air.width_x;
      air.y = (box.ny + air.width_y - 1) / air.width_y;
      for (int block = 0; block < air.count(); ++block) add_cell(k, 0);
    }
    grid.air.push_back(air);
  }
  mark_uniform_levels(grid);
  return grid;
}

inline SolverOptions coarse_options() {
  SolverOptions options;
  options.control_points = 42;
  options.directions = "double-gauss-6x8";
  options.fit.delta_m_order = 6;
  options.fit.beam_delta_m_order = 8;
  options.fit.exact_moments = 2;
  options.fit.beam_half_range_rows = 2;
  options.gather_directions = 64;
  options.beam_rays = 4;
  return options;
}

}  // namespace cloudbow
