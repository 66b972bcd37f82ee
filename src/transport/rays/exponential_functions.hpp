// The functions of transport through a cell of optical path t (docs/theory.md, "March along a ray"):
//   phi1 = (1 - e^-t)/t,  phi_{k+1} = (1/k! - phi_k)/t.
// Float: one rational approximation for all. phi1 = N/Q, phi2 = B/Q, phi3 = C/Q, phi4 = D/Q, with Q = N + t B. Energy
// is then conserved to the last digit, whatever the error of the fit (2e-6 of phi1, 3e-6 in t phi2 and t phi3). All
// coefficients are positive, so all four functions are. D follows from the recursion, coefficient by coefficient. phi4
// is off by .15 % at t = 0; energy does not depend on it. Double: exact to rounding.
#pragma once

#include <algorithm>
#include <cmath>

namespace cloudbow {

/// phi1 to phi4 at t >= 0.
template <class Real>
struct ExponentialFunctions {
  Real phi1;
  Real phi2;
  Real phi3;
  Real phi4;
};

/// Longer optical paths are replaced by this one. Mean radiance and source then agree to the last digit of float. The
/// sixth power of t is still in its range.
inline constexpr float largest_optical_path = 5e6F;

// The approximation, for float or lanes of it, up to largest_optical_path. Inlined always: a call inside a loop over
// rays would keep it from being vectorised.
template <class Value>
[[gnu::always_inline]] inline ExponentialFunctions<Value> rational_exponential_functions(const Value& t) {
  const Value n = 1.F + t * (.2356420609F +
                             t * (.06120111118F + t * (.009783008893F + t * (.001078225308F + t * .0001481520364F))));
  const Value b = .5F + t * (.2011543638F +
                             t * (.05017445831F + t * (.008730071922F + t * (.0009299086192F + t * .0001481520364F))));
  const Value c =
      .1666666667F +
      t * (.08100327917F + t * (.02124866168F + t * (.003974239996F + t * (.0003908782914F + t * .0000740760182F))));
  const Value d =
      .04160373098F +
      t * (.02247725082F + t * (.006018671205F + t * (.001243837914F + t * (.0001056007577F + t * 2.469200607e-05F))));
  const Value inverse = 1.F / (n + t * b);
  return {n * inverse, b * inverse, c * inverse, d * inverse};
}

template <class Value>
[[gnu::always_inline]] inline ExponentialFunctions<Value> exponential_functions(const Value& t) {
  return rational_exponential_functions(t);
}

// Sum over k of (-t)^k order! / (k + order)!, enough terms for 1e-17 at 0.7.
template <int order>
[[gnu::always_inline]] inline double exponential_series(double t) {
  double sum = 1;
  for (int k = 14; k >= 0; --k) sum = sum * (-t / (k + order + 1)) + 1.;
  return sum;
}

// Inlined always, so that a kernel without phi4 does not compute it.
[[gnu::always_inline]] inline ExponentialFunctions<double> exponential_functions(double t) {
  if (t < 0.7) {
    const double phi3 = exponential_series<3>(t) / 6.;
    const double phi2 = .5 - t * phi3;
    return {1. - t * phi2, phi2, phi3, exponential_series<4>(t) / 24.};
  }
  const double phi1 = -std::expm1(-t) / t;
  const double phi2 = (1. - phi1) / t;
  const double phi3 = (.5 - phi2) / t;
  return {phi1, phi2, phi3, (1. / 6 - phi3) / t};
}

/// e^-x for x >= 0 in float, relative error 1e-7 down to e^-87, branch-free so that loops over rays vectorise.
[[gnu::always_inline]] inline float transmission(float x) {
  const float scaled = std::min(x * 1.44269504F, 126.F);
  const float n = std::nearbyint(scaled);
  float f = n * 0.693145752F - std::min(x, 87.3365F);  // Cody-Waite: n ln 2 - x without cancellation
  f += n * 1.42860677e-6F;
  float p = 1.9841270e-4F;
  p = p * f + 1.3888889e-3F;
  p = p * f + 8.3333333e-3F;
  p = p * f + 4.1666667e-2F;
  p = p * f + 1.6666667e-1F;
  p = p * f + 0.5F;
  p = p * f + 1.F;
  p = p * f + 1.F;
  return p * __builtin_bit_cast(float, (127 - static_cast<int>(n)) << 23);
}
inline double transmission(double x) { return std::exp(-x); }

}  // namespace cloudbow
