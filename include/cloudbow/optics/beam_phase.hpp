// First scattering of a beam that carries the light of its truncated forward peak (delta-M), as it is seen: the whole
// phase function for light that never scattered, and for light that went through the peak already, the peak's own
// width.
//
// With r_l = chi_l / f, f = chi_N, light scattered k times within the peak has the moments r_l^k for l >= N (and 1
// below: that is what truncation means). After an optical depth lambda of scattering into the peak, k is distributed as
// Poisson's law says, so that the beam scatters by
//     P(cos) + f sum_{l >= N} (2l+1) r_l (exp(-lambda (1 - r_l)) - 1) P_l(cos).
// lambda = 0 is the correction of Nakajima & Tanaka (1988) called TMS; their IMS is the first order in lambda.
//
// Seen straight on, within half a resolved angle of the beam (pi / 2N, fading until pi / N), light scatters on in the
// peak after it was sent towards the eye, and must not be seen twice. What is seen after lambda in all is known there:
// the small-angle solution exp(-lambda (1 - r_l)) - exp(-lambda). Each place sends what that gains there,
//     r_l exp(-lambda (1 - r_l))  ->  exp(-lambda) - (1 - r_l) exp(-lambda (1 - r_l)),
// which may be negative: the peak widens.
#pragma once

#include <span>
#include <vector>

#include "cloudbow/optics/delta_m.hpp"

namespace cloudbow {

class BeamPhase {
 public:
  /// @param truncation of `phase`; its order is that of its moments.
  BeamPhase(const PhaseFunction& phase, const DeltaM& truncation);

  /// Depths lambda >= 0 stand at nodes, the first at 0.
  static constexpr int nodes = 40;
  /// Place of a depth among the nodes, 0 to nodes - 1; beyond the last it stays there.
  static double place(double lambda);

  /// Mean-1 phase function at the nodes, for one cosine of the scattering angle. Linear between nodes to 1 % of the
  /// correction.
  std::vector<double> at(double cos_angle) const;

 private:
  PhaseFunction phase_;
  int order_ = 0;  // N
  // [nodes][moments beyond N]: what is added to f (2l+1) r_l, seen aside and straight on
  std::vector<double> aside_, straight_;
  std::size_t beyond_ = 0;  // moments from N on
};

}  // namespace cloudbow
