// Delta-M truncation of a forward peak (Wiscombe 1977).
#pragma once

#include "cloudbow/optics/phase_function.hpp"

namespace cloudbow {

struct DeltaM {
  double forward_fraction;  ///< f = chi_N, taken as unscattered; 0 if the function has no forward peak
  PhaseFunction truncated;  ///< chi'_l = (chi_l - f)/(1 - f), l < N; the function itself (exact) if f = 0
};

/// Truncates at order N >= 1. Only a forward peak is truncated: chi_N > 0 and chi_l >= chi_N for all l < N, otherwise f
/// = 0.
DeltaM delta_m(const PhaseFunction& phase, int order);

}  // namespace cloudbow
