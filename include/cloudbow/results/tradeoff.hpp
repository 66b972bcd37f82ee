// Error against cost: one scene solved at several levels of accuracy.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace cloudbow {

/// Light that leaves the domain through its top and bottom, at one wavelength.
struct BoundaryFluxes {
  double reflectance = 0;  ///< fractions of the power that enters through the top, or is emitted
  double transmittance = 0;
  std::vector<double> up_at_top;       ///< [y][x] W m-2
  std::vector<double> down_at_bottom;  ///< [y][x] W m-2, direct and diffuse
};

/// Cost of a solve; of a spectrum, all wavelengths together.
struct SolveCost {
  double cpu_seconds = 0;
  double wall_seconds = 0;
  double table_seconds = 0;  ///< of wall_seconds: scattering tables, made or read from their cache
  double peak_memory_bytes = 0;
  int sweeps = 0;
  int control_points = 0;
  double estimated_error = 0;  ///< of the iteration, the largest
  bool converged = false;
};

struct BoundaryResult {
  std::string file;
  std::vector<double> x_m, y_m;        ///< centres of the columns
  std::vector<double> wavelengths_um;  ///< empty: no spectrum
  std::vector<BoundaryFluxes> fluxes;  ///< of each wavelength, or one
  SolveCost cost;
};

/// In per cent; of a spectrum, the largest of all wavelengths.
struct FluxErrors {
  double domain = 0;  ///< the larger of |dR| and |dT|, of incident
  double up = 0;      ///< RMS over columns / mean of the truth: up at the top
  double down = 0;    ///< the same: down at the bottom
};

/// @throws InputError if the two have other columns or wavelengths.
FluxErrors flux_errors(const BoundaryResult& result, const BoundaryResult& truth);

/// Points that no other beats: none has less of one and no more of the other. Equal points: the first alone. Points
/// whose error is not finite are left out. @returns indices by ascending cost.
std::vector<std::size_t> pareto_front(std::span<const double> cost, std::span<const double> error);

}  // namespace cloudbow
