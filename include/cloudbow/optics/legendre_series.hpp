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

/// Up to this share of the largest term in its last one, a series is taken for the front of a longer one, which was cut
/// once its terms were small; above, for a polynomial that is meant as it stands.
inline constexpr double fallen = 0.05;

/// The least value that a phase function of mean 1 may have. Moments of three decimals leave -0.001. A series that was
/// cut rings: at 180 degrees, where its terms alternate, by half of the term after the last, and nowhere by more than
/// its last; this much is let pass, down to -0.1.
double least_allowed(std::span<const double> moments);

/// @returns what the user must be told of a series that rings below 0, else nothing.
/// @throws InputError if the series is negative beyond least_allowed(), with the value, the angle and what mends it.
std::string check_not_negative(std::span<const double> moments);

}  // namespace cloudbow
