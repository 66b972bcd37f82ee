// Light crosses one cell: the radiance at the exit and its mean along the chord (docs/theory.md, Eqs. 18 to 20).
#pragma once

#include <algorithm>
#include <type_traits>

#include "transport/grid/lanes.hpp"
#include "transport/rays/exponential_functions.hpp"

namespace cloudbow {

/// Optical path of a chord, limited to the range in which its functions are accurate.
template <class Value, class Real>
[[gnu::always_inline]] inline Value optical_path(const Value& extinction, Real length) {
  constexpr Real largest = static_cast<Real>(largest_optical_path);
  const Value t = extinction * length;
  if constexpr (std::is_same_v<Value, Real>) {
    return std::min(t, largest);
  } else {
    return t < largest ? t : largest + Value{};
  }
}

/// A ray in a cell. The source has the value `entry` at the entry of light and `exit` at its exit. It is linear between
/// (Eq. 20), or it is constant (Eq. 19). With e^-t = 1 - t phi1, no term is negative if no source and no radiance is.
/// @tparam Value float, double, or lanes of float: one ray for each lane.
template <class Value>
struct Crossing {
  Value t;  ///< optical path, 0 to largest_optical_path
  ExponentialFunctions<Value> phi;

  [[gnu::always_inline]] explicit Crossing(const Value& path) : t(path), phi(exponential_functions(path)) {}

  /// Light of the cell itself that leaves it, per unit of t.
  [[gnu::always_inline]] Value emitted(const Value& entry, const Value& exit) const {
    return phi.phi2 * exit + (phi.phi1 - phi.phi2) * entry;
  }
  /// I_out.
  [[gnu::always_inline]] Value leaving(const Value& in, const Value& emission) const {
    return in + t * (emission - phi.phi1 * in);
  }
  /// I_mean.
  [[gnu::always_inline]] Value mean(const Value& in, const Value& entry, const Value& exit) const {
    return phi.phi1 * in + t * ((phi.phi2 - phi.phi3) * entry + phi.phi3 * exit);
  }

  /// Mean of s I(s), with s = 0 at the entry and 1 at the exit (Eq. 20d).
  [[gnu::always_inline]] Value first_moment(const Value& in, const Value& entry, const Value& exit) const {
    return (phi.phi1 - phi.phi2) * in +
           t * ((phi.phi2 - 2 * phi.phi3 + phi.phi4) * entry + (phi.phi3 - phi.phi4) * exit);
  }

  /// I_out of a constant source.
  [[gnu::always_inline]] Value leaving_constant(const Value& in, const Value& source) const {
    return in + t * phi.phi1 * (source - in);
  }
  /// I_mean of a constant source.
  [[gnu::always_inline]] Value mean_constant(const Value& in, const Value& source) const {
    return phi.phi1 * in + t * phi.phi2 * source;
  }

  /// The share of the entering light that does not leave, 1 - e^-t.
  [[gnu::always_inline]] Value absorbed() const { return t * phi.phi1; }
};

}  // namespace cloudbow
