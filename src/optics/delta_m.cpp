#include "cloudbow/optics/delta_m.hpp"

#include <cassert>

namespace cloudbow {

DeltaM delta_m(const PhaseFunction& phase, int order) {
  assert(order >= 1);
  const double f = phase.moment(order);
  bool is_forward_peak = f > 0;
  for (int l = 0; l < order; ++l) is_forward_peak = is_forward_peak && phase.moment(l) >= f;
  // f = 1 would leave nothing to scatter.
  if (!is_forward_peak || f >= 1) return {0, phase};

  std::vector<double> moments(order);
  for (int l = 0; l < order; ++l) moments[l] = (phase.moment(l) - f) / (1 - f);
  return {f, PhaseFunction::legendre(std::move(moments))};
}

}  // namespace cloudbow
