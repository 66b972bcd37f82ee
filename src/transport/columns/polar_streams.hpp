// Light averaged over the azimuth, in a few polar directions: all that the fluxes of a plane-parallel column need.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "cloudbow/optics/phase_function.hpp"

namespace cloudbow {

/// Directions of each hemisphere and how phase functions act between them (docs/theory.md, Eq. 33 and 34). Peaks are
/// truncated by delta-M, that of the diffuse light and that of the beam each at its own order.
struct PolarStreams {
  struct Scattering {
    double diffuse_fraction;             ///< f of delta-M
    double beam_fraction;                ///< f_b
    std::vector<double> even, odd;       ///< [n(n+1)/2] lower triangles of K+ and K-
    std::vector<double> from_beam_even;  ///< [n] k+ of the sun's direction
    std::vector<double> from_beam_odd;   ///< [n] k-
  };

  std::vector<double> cosine;  ///< [n] |mu|, ascending in (0, 1)
  std::vector<double> weight;  ///< [n] sum 1
  std::vector<Scattering> phase;

  int size() const { return static_cast<int>(cosine.size()); }
};

/// Gauss-Legendre nodes of each half range.
/// @param count n of a hemisphere, >= 2.
/// @param sun_cosine mu0 in (0, 1]; none: no sun.
PolarStreams make_polar_streams(int count, std::span<const PhaseFunction> phase, std::optional<double> sun_cosine);

}  // namespace cloudbow
