// Settings of a solve, and the requested outputs.
#pragma once

#include <numbers>
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
  int width = 0;     ///< pixels along x and y over the domain's horizontal extent; 0: one per column
  int height = 0;
};

enum class FluxLevels { all, boundaries, listed };

/// How finely directions are resolved.
struct AngularOptions {
  int control_points = 162;
  std::string directions = "double-gauss-8x16";  ///< an ordinate set by name
  FitOptions fit;
  /// Directions per hemisphere in the final gather, >= 1. Independent columns need none.
  int gather_directions = 512;
  int beam_rays = 16;      ///< rays of the direct beam per column, a square number
  int column_streams = 8;  ///< polar directions per hemisphere for columns solved without azimuths: 2 to 16
};

/// How space is treated.
struct SpatialOptions {
  bool independent_columns = false;   ///< no light crosses from column to column
  bool beam_crosses_columns = false;  ///< with independent_columns: but the direct beam does
  /// Horizontal axes along which nothing varies are collapsed to one cell: the same answer for less.
  bool collapse_uniform_axes = false;
  /// Whether the source is linear within a cell; false: constant, which shows the effect of the size of cells.
  bool linear_source = true;
  /// Levels in which the direct beam fades are subdivided, the first part of this slant optical depth
  /// (SubdividedLevels); 0: as they are.
  double max_level_optical_depth = 0;
  /// Columns of thick voxels are subdivided into parts of this optical depth from side to side (SubdividedColumns); 0:
  /// as they are.
  double max_column_optical_depth = 0;
  /// But into no more parts along an axis, 1 to 16.
  int max_column_parts = 3;
};

/// Convergence criteria of the iteration, and its storage.
struct IterationOptions {
  double tolerance = 1e-4;  ///< estimated true relative error of the iteration
  double energy_tolerance = 1e-5;
  int max_sweeps = 200;
  /// Radiance and source of the cells are stored as float16, for half the memory; not if the solve is in double.
  bool half_precision_radiance = false;
};

/// Of OutputOptions::circumsolar_half_angle: 10 degrees. The light beside the forward peak is taken from one direction.
inline constexpr double largest_circumsolar_half_angle = 10 * std::numbers::pi / 180;

/// Contents of a solution.
struct OutputOptions {
  FluxLevels flux_levels = FluxLevels::all;
  std::vector<int> listed_levels;  ///< indices of z_edge, ascending, if flux_levels is listed
  bool absorption = true;
  bool actinic = false;
  bool radiance_field = false;
  /// Half angle in radians of the cone about the sun whose diffuse light is requested, at most
  /// largest_circumsolar_half_angle; 0: not requested.
  double circumsolar_half_angle = 0;
  std::vector<View> views;
  std::vector<Camera> cameras;
};

struct ExecutionOptions {
  /// 1D scenes cost nothing in double. Very thick cells always use it, and thick media with a small tolerance if 2 GB
  /// more are enough for that.
  bool double_precision = false;
  int threads = 0;  ///< 0: all that OpenMP gives
};

struct SolverOptions : AngularOptions, SpatialOptions, IterationOptions, OutputOptions, ExecutionOptions {};

/// Indices of z_edge, ascending, at which a solution holds fluxes.
std::vector<int> flux_levels(const BoxGrid& box, const OutputOptions& options);

}  // namespace cloudbow
