// What is solved and what comes out, in plain arrays. Conventions: z up, k and z_edge ascend; light is given by its
// direction of travel.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cloudbow/medium/optical_grid.hpp"
#include "cloudbow/medium/surface.hpp"
#include "cloudbow/optics/phase_function.hpp"
#include "cloudbow/optics/scattering_table.hpp"
#include "cloudbow/transport/camera.hpp"
#include "cloudbow/transport/checkpoints.hpp"

namespace cloudbow {

/// Irradiances and sky radiances, where they are not 0: float then holds every flux and radiance that is 1e-12 of them
/// or more, and everything that a cloud or surface focuses.
inline constexpr double least_light = 1e-25, most_light = 1e25;

struct Sun {
  Direction travel;       ///< direction in which sunlight travels, z < 0
  double irradiance = 1;  ///< W m-2, 0 or least_light to most_light, through a surface that faces the sun
};

struct Problem {
  OpticalGrid grid;
  std::vector<PhaseFunction> phase;  ///< one for each of grid.scattering
  std::optional<Sun> sun;
  double sky_radiance = 0;  ///< W m-2 sr-1, 0 or least_light to most_light, uniform diffuse light from above
  Surface surface;
};

/// Parallel lines of sight; light that travels up is seen at the domain's top, light that travels down at its bottom.
struct View {
  std::string name;
  Direction travel;  ///< of the light that is seen, z != 0
  int width = 0;     ///< pixels along x and y over the domain's horizontal extent; 0: one a column
  int height = 0;
};

struct RadianceImage {
  View view;
  std::vector<float> radiance;  ///< [height][width] of the view, else [ny][nx]; y ascending; W m-2 sr-1, mean over the
                                ///< pixel where the line of sight crosses that plane
};

enum class FluxLevels { all, boundaries, listed };

struct SolverOptions {
  int control_points = 162;
  std::string directions = "double-gauss-8x16";  ///< an ordinate set by name
  FitOptions fit;
  int gather_directions =
      512;             ///< directions a hemisphere in the last gather, >= 1; columns that exchange no light do without
  int beam_rays = 16;  ///< rays of the direct beam a column, a square number
  double tolerance = 1e-4;  ///< estimated true relative error of the iteration
  double energy_tolerance = 1e-5;
  int max_sweeps = 200;
  bool independent_columns = false;   ///< no light crosses from column to column
  bool beam_crosses_columns = false;  ///< with independent_columns: but the direct beam does
  int column_streams = 8;  ///< polar directions a hemisphere where columns are solved without azimuths: 2 to 16
  /// Horizontal axes along which nothing varies are left out (uniform_axes.hpp): the same answer for less.
  bool leave_out_uniform_axes = false;
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

/// Fractions of the solar power through the horizontal top (with sky: of all power that enters through the top).
/// docs/theory.md, "Energy".
struct EnergyLedger {
  double reflectance = 0;
  double transmittance = 0;         ///< direct and diffuse
  double transmittance_direct = 0;  ///< true extinction
  double absorptance = 0;           ///< volume integral of absorbed_power
  double surface_absorptance = 0;
  double side_gain = 0;
  double side_loss = 0;
  double residual = 0;  ///< 1 + side_gain - (reflectance + absorptance + surface_absorptance + side_loss)
};

struct SolverReport {
  bool converged = false;  ///< estimated error within tolerance and ledger within energy_tolerance
  int sweeps = 0;
  double estimated_error = 0;
  double gather_rescaling =
      1;  ///< factor that brought the gathered diffuse flux to the solver's mean (the one farthest from 1)
  int control_points = 0;
  std::string directions;
  std::string mode;           ///< "1d", "2d", "3d", "independent-columns" or "independent-diffuse"
  std::string left_out_axes;  ///< "x", "y", "x, y" or nothing: along which nothing varies, so that one cell was solved
  int added_levels = 0;       ///< by cutting levels in which the direct beam fades
  std::string radiance_storage;  ///< "float16", "float32" or "float64"
  std::size_t active_voxels = 0;
  int threads = 1;
  double seconds_total = 0;
  double seconds_tables = 0;
  double seconds_beam = 0;
  double seconds_sweeps = 0;
  double seconds_scattering = 0;
  double seconds_acceleration = 0;
  double seconds_gather = 0;
  double cpu_seconds = 0;
  std::size_t peak_memory_bytes = 0;
  double fit_closure = 0;
  double fit_max_error = 0;
  int fit_fallbacks = 0;
  double surface_largest_albedo = 0;      ///< directional-hemispherical, of the model itself; above 1 it was held to 1
  double surface_largest_correction = 0;  ///< worst |factor - 1| that gave a column of its table that albedo
};

struct RadianceField {
  std::vector<Direction> direction;                   ///< M control points: where light travels to
  std::vector<std::array<std::int32_t, 3>> triangle;  ///< of control points, counter-clockwise seen from outside
  std::vector<std::array<std::int32_t, 3>> voxel;     ///< n active voxels: i, j, k
  std::vector<float> radiance;                        ///< n x M, W m-2 sr-1, voxel mean, diffuse
};

struct Solution {
  BoxGrid box;
  std::optional<Sun> sun;                       ///< that of the problem
  std::vector<int> flux_level;                  ///< indices of z_edge at which the fields below are given, ascending
  std::vector<float> upwelling_flux;            ///< [level][ny][nx] W m-2, diffuse
  std::vector<float> downwelling_diffuse_flux;  ///< as above
  std::vector<float> direct_flux;               ///< as above, true extinction, through a horizontal surface
  std::vector<double> profile_upwelling_flux;   ///< [nz+1] domain means
  std::vector<double> profile_downwelling_diffuse_flux;
  std::vector<double> profile_direct_flux;
  std::vector<float> absorbed_power;  ///< [nz][ny][nx] W m-3, empty unless asked
  std::vector<float>
      actinic_flux;  ///< [nz][ny][nx] W m-2, empty unless asked; NaN where no light was computed (empty cells)
  std::vector<RadianceImage> images;       ///< one for each of SolverOptions::views
  std::vector<CameraImage> camera_images;  ///< one for each of SolverOptions::cameras
  std::optional<RadianceField> radiance_field;
  EnergyLedger ledger;
  SolverReport report;
};

/// Told after each sweep and phase; may throw to stop the solve.
struct SolverProgress {
  std::string phase;  ///< "tables", "beam", "sweep", "gather"
  int sweep = 0;
  double estimated_error = 0;
  double energy_residual = 0;
  double fraction = 0;  ///< of this phase
};
using ProgressCallback = std::function<void(const SolverProgress&)>;

/// Indices of z_edge, ascending, at which a solution holds fluxes.
std::vector<int> flux_levels(const BoxGrid& box, const SolverOptions& options);

/// Solves the problem. @throws InputError for options out of range (names of ordinate sets, counts of control points),
/// for light out of range and for cells too thick to be solved (thick_cells.hpp).
/// @throws std::runtime_error if a value of the solution is not finite.
/// @param checkpoints where the iteration begins and leaves its state, or null; solves without iteration leave none.
Solution solve(const Problem& problem, const SolverOptions& options, const ProgressCallback& progress = {},
               Checkpoints* checkpoints = nullptr);

/// Peak memory in bytes that solve() will need, within about 10 %. @throws InputError as solve() for rays that cross
/// too many cells.
std::size_t predict_memory(const Problem& problem, const SolverOptions& options);
/// Wall seconds on this machine, a rough prediction from segment counts.
double predict_seconds(const Problem& problem, const SolverOptions& options);

}  // namespace cloudbow
