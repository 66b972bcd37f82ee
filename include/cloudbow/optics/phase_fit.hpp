// Fits of a phase function about one direction of arrival to control points, by every method, and their errors.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "cloudbow/optics/phase_function.hpp"
#include "cloudbow/sphere/control_points.hpp"
#include "cloudbow/sphere/ordinate_set.hpp"

namespace cloudbow {

/// The first five are plain: nothing holds their integral, nothing keeps them positive. The last three hold the moments
/// l <= exact_moments exactly and stay >= min(0, min P).
enum class PhaseFitMethod {
  collocation,                     ///< the function's values at the control points
  least_squares,                   ///< X = (A^T A)^-1 A^T Y
  minimax_absolute,                ///< least h, |A X - Y| <= h (Chatelier & Malgouyres, Eq. 5)
  minimax_relative,                ///< least h, |A X - Y| <= h |Y| (Eq. 6)
  minimax_square_root,             ///< least h, |A X - Y| <= h sqrt |Y| (Eq. 7)
  linear_programming,              ///< the solver's: FitMethod::linear_programming; moments under the ordinates
  linear_programming_interpolant,  ///< the same, moments as integrals of the interpolant itself
  linear_programming_bounded,      ///< as the solver's, least mean error among those with |A X - Y| <= bound_factor
                                   ///< times the least possible, or the least that the moments allow
};

/// "collocation", "least-squares", "minimax-absolute", ..., in the order of the enumeration.
std::vector<std::string> phase_fit_names();
std::string name_of(PhaseFitMethod method);
/// @throws InputError listing what is allowed.
PhaseFitMethod phase_fit_method(const std::string& name);

struct PhaseFitOptions {
  Direction travel{0.36, 0.48, -0.8};  ///< in which the arriving light travels: no symmetry of the points favours it
  int exact_moments = 3;               ///< 1 to 12
  double bound_factor = 1.2;           ///< of linear_programming_bounded
};

/// Of the interpolant, in units of P (mean 1). Errors are taken at the samples of the fits: the 642 vertices of an
/// icosphere, or 2562 for 642 control points. Errors "between" are at the 10242 vertices of a finer one.
struct PhaseFitErrors {
  double max_error = 0;
  double worst_angle_deg = 0;  ///< scattering angle of the sample of max_error
  double rms_error = 0;
  double relative_rms_error = 0;     ///< root of the mean square of error / |P|, |P| >= 1e-6 max |P|
  double scaled_error = 0;           ///< largest error / sqrt(max(|P|, .05)): what the solver's fit minimises
  double max_error_between = 0;      ///< at the finer vertices
  double ordinate_norm = 0;          ///< chi_0 as the ordinates' quadrature sees the interpolant
  double ordinate_asymmetry = 0;     ///< chi_1, in the same way
  double interpolant_norm = 0;       ///< chi_0 as the integral of the interpolant itself
  double interpolant_asymmetry = 0;  ///< chi_1, in the same way
  double least_value = 0;            ///< at the control points: the interpolant is nowhere lower
};

struct PhaseFit {
  PhaseFitMethod method = PhaseFitMethod::collocation;
  Eigen::VectorXd value;  ///< at the control points; empty if the solver found no solution
  PhaseFitErrors errors;
  int exact_degree = -1;  ///< moments l <= this were prescribed: fewer than requested if no positive solution has them
  double seconds = 0;
};

/// Directions and weights [sr] that integrate interpolants times smooth functions: Gauss points in every triangle of
/// the control points. Norm and g come out to 1e-12.
OrdinateSet interpolant_quadrature(const ControlPoints& points);

/// One fit for each method, in that order.
/// @param ordinates the solver's quadrature
/// @throws InputError for exact_moments or bound_factor out of range, or a direction of no length.
std::vector<PhaseFit> fit_phase_function(const PhaseFunction& phase, const ControlPoints& points,
                                         const OrdinateSet& ordinates, std::span<const PhaseFitMethod> methods,
                                         const PhaseFitOptions& options);

/// Values of an interpolant on the great circle through the direction of travel, at angles [deg] from it; angles
/// beyond 180 lie on the other side.
std::vector<double> great_circle_section(const ControlPoints& points, const Eigen::VectorXd& value,
                                         const Direction& travel, std::span<const double> angle_deg);

}  // namespace cloudbow
