// Legendre series sum (2l+1) chi_l P_l: their sum, and whether it is a phase function, which is nowhere negative.
#pragma once

#include <span>
#include <string>

namespace cloudbow {

/// Clenshaw's recurrence for sum (2l+1) chi_l P_l(x).
double legendre_sum(std::span<const double> moments, double x);

struct LeastValue {
  double value = 0;
  double angle_deg = 0;
};

/// The least value of the series, of scattering angles that resolve its waves up to degree 125 and sample them beyond.
LeastValue least_value(std::span<const double> moments);

/// (2l+1) |chi_l| of the last moment that is not 0, and the largest of all.
struct SeriesTerms {
  double last = 0;
  double largest = 0;
};
SeriesTerms terms_of(std::span<const double> moments);

/// Largest ratio of the last term to the largest term for which a series counts as truncated. It is then the start of a
/// longer one that was cut once its terms were small. Above, it counts as a complete polynomial.
inline constexpr double fallen = 0.05;

/// The least value that a phase function of mean 1 may have. Moments of three decimals leave -0.001. A truncated series
/// rings. At 180 degrees, at which its terms alternate, it does so by half of the term after the last. It nowhere does
/// so by more than its last term; this much is allowed, down to -0.1.
double least_allowed(std::span<const double> moments);

/// @returns a note for the user on a series that rings below 0, else nothing.
/// @throws InputError if the series is negative beyond least_allowed(), with the value, the angle and the remedy.
std::string check_not_negative(std::span<const double> moments);

}  // namespace cloudbow
