// The direct beam: sunlight that has not scattered. It is marched along the sun's direction with several rays per
// column and no source.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "cloudbow/transport/solution.hpp"
#include "transport/rays/march.hpp"

namespace cloudbow {

template <class Real>
struct DirectBeam {
  std::vector<Real> irradiance;  ///< [n] voxel-mean irradiance on a surface facing the sun, W m-2; empty: not requested
  /// [requested interfaces][ny*nx] through a horizontal surface, mean over the column, W m-2; interfaces ascend.
  std::vector<double> level_flux;
  std::vector<int> level;         ///< [nz+1] index of each interface among these; -1: not requested
  std::vector<double> mean_flux;  ///< [nz+1] its domain means, of all interfaces
  /// [n + lane_padding] slope of the irradiance from face to face along x, y, z, relative to it; empty: not requested
  std::array<std::vector<Real>, 3> slope;
  double side_gain = 0;  ///< power through the sunlit open sides per area of the top, W m-2
  double side_loss = 0;

  /// [ny*nx] level_flux at one interface, which was requested.
  std::span<const double> flux_at(int edge) const {
    const std::size_t columns =
        level_flux.size() / static_cast<std::size_t>(1 + *std::max_element(level.begin(), level.end()));
    return std::span(level_flux).subspan(static_cast<std::size_t>(level[edge]) * columns, columns);
  }
};

/// Requested parts of a beam, beside its domain means.
struct BeamParts {
  bool irradiance = true;  ///< of the cells
  bool slopes = false;     ///< of the irradiance too
  /// Interfaces whose flux is requested by column; none: all. In an open box all are.
  std::optional<std::vector<int>> levels = {};
};
/// Irradiance alone.
inline const BeamParts of_cells{true, false, std::vector<int>{}};

struct BeamOptions {
  int rays = 16;                     ///< a column, a square number
  bool independent_columns = false;  ///< independent columns: the beam stays in its column
  BeamParts parts = {};
};

/// @param extinction [n] 1/m of the active cells; @param layer_extinction [nz] of the layers alone, which light coming
/// in through open sides has crossed. Exact (Beer-Lambert) along each ray. The same bits for any number of threads.
template <class Real>
DirectBeam<Real> direct_beam(const BoxGrid& box, const ActiveRows& rows, std::span<const Real> extinction,
                             std::span<const double> layer_extinction, const Sun& sun, const BeamOptions& options);

}  // namespace cloudbow
