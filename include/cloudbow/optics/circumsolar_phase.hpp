// Scattering of sunlight into a cone about the sun, as means over rings of the cone. Ring means are exact for forward
// peaks of any width (docs/theory.md, Eq. 32f).
//
// The beam of the iteration carries the light of its truncated forward peak (delta-M). Let lambda be the optical depth
// of scattering into the peak, and r_l = chi_l / f (1 for l < N). That light has the small-angle moments
//     exp(-lambda (1 - r_l)) - exp(-lambda).
// Each location emits the increase of these with lambda:
//     f sum_l (2l+1) [exp(-lambda) - (1 - r_l) exp(-lambda (1 - r_l))] P_l(cos).
// It may be negative: the peak widens.
#pragma once

#include <span>
#include <vector>

#include "cloudbow/optics/delta_m.hpp"

namespace cloudbow {

/// Directions at angles between `inner` and `outer` from the sun's direction of travel, in radians. Means over a ring
/// are weighted with the cosine of the angle.
struct ConeRing {
  double inner = 0;
  double outer = 0;

  double power() const;        ///< integral of the cosine over the ring, sr
  double mean_cosine() const;  ///< of the angle
};

/// A cone of the half angle `half_angle` in radians, in (0, pi/2), as `count` >= 1 rings of equal widths.
std::vector<ConeRing> cone_rings(double half_angle, int count);

class CircumsolarPhase {
 public:
  /// @param truncation [p] of the phase functions, at one order. @param weight [p] >= 0: how much each scatters in all.
  /// The widening of the peak is that of their mean.
  CircumsolarPhase(std::span<const PhaseFunction> phase, std::span<const DeltaM> truncation,
                   std::span<const double> weight, std::span<const ConeRing> rings);

  /// Depths lambda >= 0 stand at nodes, the first at 0.
  static constexpr int nodes = 96;
  /// Place of a depth among the nodes, 0 to nodes - 1; beyond the last it stays there.
  static double place(double lambda);

  /// (1 - f) P', the scattering out of the beam, mean over a ring.
  double rest(std::size_t p, std::size_t ring) const { return of_phase_[p].rest[ring]; }
  /// [nodes] the emission above as a phase function, mean over a ring; empty if p has no forward peak.
  std::span<const double> peak(std::size_t p, std::size_t ring) const;
  /// [nodes] 4 pi times the radiance of the light in the peak, per irradiance of the beam, mean over a ring.
  std::span<const double> carried(std::size_t ring) const;
  bool has_peak() const { return has_peak_; }

 private:
  struct OfPhase {
    std::vector<double> rest;               // [ring]
    std::vector<std::vector<double>> peak;  // [ring][nodes]; empty: no peak
  };
  std::vector<OfPhase> of_phase_;
  std::vector<std::vector<double>> carried_;  // [ring][nodes]
  bool has_peak_ = false;
};

}  // namespace cloudbow
