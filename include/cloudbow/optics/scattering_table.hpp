// The scattering matrix on control points: column d is the phase function for light arriving along ordinate d, fitted
// to the control points.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

#include "cloudbow/optics/delta_m.hpp"
#include "cloudbow/sphere/ordinate_set.hpp"

namespace cloudbow {

/// linear_programming: per column minimises h + 20 mean(|r|) over samples of residual r scaled by sqrt(max(|P|, .05)).
/// Constraints: |r| <= h, the exact rows and X >= min(0, min P). The other two fit without constraints (all samples
/// alike; values at the control points). They then take the least relative correction that makes the same rows exact,
/// which may turn values negative.
enum class FitMethod { linear_programming, least_squares, collocation };

struct FitOptions {
  FitMethod method = FitMethod::linear_programming;
  int delta_m_order = 8;                  ///< N of the diffuse light
  int beam_delta_m_order = 12;            ///< N_b >= N of the direct beam
  int exact_moments = 3;                  ///< moments l <= this hold exactly under the ordinates' quadrature
  int beam_half_range_rows = 3;           ///< rows int_up mu^k P, k = 0 .. rows-1, held exactly for the beam
  bool minimax = true;                    ///< false: mean error alone
  std::filesystem::path cache_directory;  ///< empty: no cache. A cache that cannot be read or written is no error
};

/// Whether a file has the name of a table in the cache.
bool is_cached_table(const std::filesystem::path& file);

/// Quality of the fit; written to the result file and by `cloudbow phase`.
struct FitReport {
  int linear_programmes = 0;
  int fallbacks = 0;   ///< columns not solved as requested (fewer rows, or least squares with correction)
  double closure = 0;  ///< worst |sum_d' w_d' T(d',d)/w_d - 1| over columns, beam included
  double least_value =
      std::numeric_limits<double>::infinity();  ///< lowest value of a fitted phase function (mean 1) at a control point
  double max_error = 0;                         ///< worst |fit - P'| / max P' at the samples
  bool from_cache = false;
  double seconds = 0;
};

/// All matrices in double. Mean-1 phase functions: the source per unit scattering coefficient is S =
/// points_from_ordinates * I with I the radiance at the ordinates; light is conserved: sum_m over the quadrature of S
/// equals the sum of w_d I_d. Isotropic light stays so: every row of points_from_ordinates sums to 1.
struct ScatteringTable {
  double forward_fraction = 0;               ///< f of the diffuse light
  double beam_forward_fraction = 0;          ///< f_b of the direct beam
  Eigen::MatrixXd points_from_ordinates;     ///< M x D: (X_d + lack of the row) w_d / (4 pi)
  Eigen::MatrixXd ordinates_from_ordinates;  ///< D x D: W * points_from_ordinates, W the interpolation (D x M)
  Eigen::VectorXd points_from_beam;          ///< M: P_b fitted / (4 pi), for unit normal irradiance; empty without beam
  Eigen::VectorXd ordinates_from_beam;       ///< D
  FitReport report;
};

/// @param beam direction of travel of the direct sunlight, if any.
/// @throws InputError unless 1 <= N <= N_b <= 64, 0 <= exact_moments <= 12 and 0 <= beam_half_range_rows <= 6.
/// Columns related by a symmetry of the ordinates are permutations of each other; threads solve the rest. Same
/// bits for any thread count.
ScatteringTable make_scattering_table(const PhaseFunction& phase, const ControlPoints& points,
                                      const OrdinateSet& ordinates, const std::optional<Direction>& beam,
                                      const FitOptions& options);

}  // namespace cloudbow
