// First scattering, as a camera sees it, of a beam that carries the light of its truncated forward peak (delta-M). It
// uses the whole phase function (Nakajima & Tanaka 1988, "TMS"), except for the sun's aureole.
//
// Within half a resolved angle of the beam (pi / 2N, fading until pi / N), light scatters on in the peak after its
// scattering towards the camera. It must not count twice. The radiance after an optical depth lambda of scattering into
// the peak is known there. With r_l = chi_l / f, f = chi_N, it is the small-angle solution of the moments l >= N:
// exp(-lambda (1 - r_l)) - exp(-lambda). Each point emits the increase of that with lambda:
//     f sum_{l >= N} (2l+1) [exp(-lambda) - (1 - r_l) exp(-lambda (1 - r_l))] P_l(cos).
// This replaces f sum (2l+1) r_l P_l(cos). It may be negative: the peak widens.
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
  int order_ = 0;               // N
  std::vector<double> change_;  // [nodes][moments beyond N]: what is added to f (2l+1) r_l straight on
  std::size_t beyond_ = 0;      // moments from N on
};

}  // namespace cloudbow
