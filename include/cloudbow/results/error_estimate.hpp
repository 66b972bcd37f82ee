// How far off the fluxes of a solution are, judged by cheaper solutions of the same problem (docs/accuracy.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// One number for each flux whose errors are reported.
struct ByFlux {
  double domain = 0;  ///< reflectance and transmittance: the larger, fraction of incident; in scenes that emit the mean
                      ///< fluxes up and down, fraction of EnergyLedger::power
  double up = 0;      ///< columns, up at the top: RMS over the columns / mean
  double down = 0;    ///< columns, down at the bottom, direct and diffuse: RMS over the columns / mean
};

/// How far apart two solutions of one problem are. Of the domain the largest difference of the mean fluxes up and down
/// at any level is taken: at the ends alone two solutions may agree by chance. Columns are those of the highest and the
/// lowest level that both hold.
ByFlux flux_distance(const Solution& solution, const Solution& other);

/// The largest distance of columns at the other levels and directions: up below the highest level that the solutions
/// hold, down above the lowest. The domain is left 0.
/// @param other holds the highest and the lowest of the solution's levels, and any of those between.
ByFlux flux_distance_between_ends(const Solution& solution, const Solution& other);

/// Error per unit of distance between solutions.
struct ErrorWeights {
  ByFlux angular;  ///< of that between the solution and its coarse solve with fewer directions
  ByFlux spatial;  ///< of that between the coarse solve and the same with a source that is constant in each cell
  ByFlux least;    ///< below which no error is believed to be
};

/// Error of blocks of air in the domain, as a part of that in columns: a tenth or less, measured.
constexpr double air_error_of_domain = .1;

/// Fractions as in ByFlux.
struct ErrorParts {
  double angular = 0;
  double spatial = 0;
  double iteration = 0;
  double spectral = 0;   ///< of the choice of g-points
  double total() const;  ///< root of the sum of squares
};

struct ErrorEstimate {
  ErrorParts domain, up, down;
  double between_ends = 0;  ///< columns, up or down, at the worst other level, RMS / mean; 0: there are the ends alone
  ByFlux angular_distance, spatial_distance;  ///< before they were weighed
  ByFlux probe_distance;                      ///< of single columns from their exact solution
  double cpu_seconds = 0;                     ///< of the coarse solves
  double table_seconds = 0;                   ///< wall seconds of theirs that went into scattering tables
  std::string calibrated_for;                 ///< a level of accuracy
  /// [ny][nx] W m-2, if requested: up at the highest level, down at the lowest. Their RMS is that of the estimate; they
  /// are large if the coarse solves differ.
  std::vector<float> upwelling_flux_error, downwelling_flux_error;

  double columns() const;  ///< the larger of up and down
};

/// Solutions with cheaper options, of the same problem.
struct CoarseSolves {
  Solution linear;    ///< fewer directions
  Solution constant;  ///< the same with SolverOptions::linear_source = false
  /// Some independent columns (probe_columns.hpp): in the approximation of the solve, and exact.
  struct Probe {
    Solution by_ordinates, exact;
  };
  std::optional<Probe> probe{};
};

/// @param fields whether the errors of single columns are requested.
ErrorEstimate estimate_error(const Solution& solution, const CoarseSolves& coarse_solves, const ErrorWeights& weights,
                             bool fields);

/// "estimated error ..." as one line in per cent, for the summary; ends with a newline.
std::string error_line(const ErrorEstimate& estimate);

}  // namespace cloudbow
