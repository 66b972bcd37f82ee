// How a problem is solved, and what is asked for.
#pragma once

#include <string>
#include <vector>

#include "cloudbow/medium/optical_grid.hpp"
#include "cloudbow/optics/scattering_table.hpp"
#include "cloudbow/transport/camera.hpp"

namespace cloudbow {

/// Parallel lines of sight; light that travels up is seen at the domain's top, light that travels down at its bottom.
struct View {
  std::string name;
  Direction travel;  ///< of the light that is seen, z != 0
  int width = 0;     ///< pixels along x and y over the domain's horizontal extent; 0: one a column
  int height = 0;
};

enum class FluxLevels { all, boundaries, listed };

struct SolverOptions {
  int control_points = 162;
  std::string directions = "double-gauss-8x16";  ///< an ordinate set by name
  FitOptions fit;
  int gather_directions =
      512;             ///< directions a hemisphere in the final gather, >= 1; columns that exchange no light do without
  int beam_rays = 16;  ///< rays of the direct beam a column, a square number
  double tolerance = 1e-4;  ///< estimated true relative error of the iteration
  double energy_tolerance = 1e-5;
  int max_sweeps = 200;
  bool independent_columns = false;   ///< no light crosses from column to column
  bool beam_crosses_columns = false;  ///< with independent_columns: but the direct beam does
  int column_streams = 8;  ///< polar directions a hemisphere where columns are solved without azimuths: 2 to 16
  /// Horizontal axes along which nothing varies are left out (uniform_axes.hpp): the same answer for less.
  bool collapse_uniform_axes = false;
  /// Radiance and source of the cells are kept in half precision, for half the memory; not where the solve is in
  /// double.
  bool half_precision_radiance = false;
  /// Whether the source changes within a cell; false: constant in each, which shows what the cells' size matters.
  bool linear_source = true;
  /// Levels in which the direct beam fades are solved in parts, the first of this slant optical depth
  /// (thick_levels.hpp); 0: as they are.
  double largest_level_depth = 0;
  bool double_precision = false;  ///< 1D scenes cost nothing in double; very thick cells take it by themselves
  FluxLevels flux_levels = FluxLevels::all;
  std::vector<int> listed_levels;  ///< indices of z_edge, ascending, where flux_levels is listed
  bool absorption = true;
  bool actinic = false;
  bool radiance_field = false;
  std::vector<View> views;
  std::vector<Camera> cameras;
  int threads = 0;  ///< 0: all that OpenMP gives
};

/// Indices of z_edge, ascending, at which a solution holds fluxes.
std::vector<int> flux_levels(const BoxGrid& box, const SolverOptions& options);

}  // namespace cloudbow
