// Course of a solve, and its energy ledger.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace cloudbow {

/// Fractions of `power`. docs/theory.md, "Energy".
struct EnergyLedger {
  /// W m-2 of the horizontal top: of sun and sky through it, and of emission by the ground and by matter. That of
  /// matter is what would leave each column, up and down, if nothing scattered (diffusivity 5/3).
  double power = 0;
  double incident = 1;          ///< of sun and sky through the top; 1 without emission
  double surface_emission = 0;  ///< by the ground
  double reflectance = 0;
  double transmittance = 0;         ///< direct and diffuse
  double transmittance_direct = 0;  ///< true extinction
  double absorptance = 0;           ///< volume integral of absorbed_power: net of what matter emits
  double surface_absorptance = 0;
  double side_gain = 0;
  double side_loss = 0;
  /// incident + surface_emission + side_gain - (reflectance + absorptance + surface_absorptance + side_loss)
  double residual = 0;
};

struct SolverReport {
  bool converged = false;  ///< estimated error within tolerance and ledger within energy_tolerance
  bool stalled = false;    ///< not converged, and more sweeps would not bring it closer in this precision
  int sweeps = 0;
  double estimated_error = 0;
  double gather_rescaling =
      1;  ///< factor that brought the gathered diffuse flux to the solver's mean (the one farthest from 1)
  int control_points = 0;
  std::string directions;
  std::string mode;            ///< "1d", "2d", "3d", "independent-columns" or "independent-diffuse"
  std::string collapsed_axes;  ///< "x", "y", "x, y" or nothing: along which nothing varies, so that one cell was solved
  int added_levels = 0;        ///< by subdividing levels in which the direct beam fades
  int column_parts_x = 1;      ///< parts of a column, subdivided because its voxels are thick
  int column_parts_y = 1;
  std::string air = "none";      ///< cells of layers beside clouds: "levels", "cells", or "none" without such layers
  int air_levels = 0;            ///< levels whose layers have cells in blocks of columns
  int air_block_columns = 0;     ///< columns of the narrowest of these blocks along x or y
  double air_error = 0;          ///< that the blocks leave in column fluxes, RMS over the columns / mean
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

/// Called after each sweep and phase; may throw to stop the solve.
struct SolverProgress {
  std::string phase;  ///< "tables", "beam", "sweep", "gather"
  int sweep = 0;
  double estimated_error = 0;
  double energy_residual = 0;
  double fraction = 0;  ///< of this phase
};
using ProgressCallback = std::function<void(const SolverProgress&)>;

}  // namespace cloudbow
