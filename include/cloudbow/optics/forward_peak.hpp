// Light that one truncation of a phase function (delta-M) leaves to the beam and a finer one does not. It counts as
// unscattered for the first and yet spreads.
#pragma once

#include <span>
#include <vector>

#include "cloudbow/optics/delta_m.hpp"

namespace cloudbow {

/// With (1 - f_g) P_g of the finer truncation and (1 - f_b) P_b of the coarser: (1 - f_g) P_g = peak + rest. About the
/// forward direction rest = (1 - f_b) P_b, so that the peak has the moments f_b - f_g below the coarser order: light
/// scattered by it any number of times, taken as scattered once, is right in all of these. Beyond a zero of the
/// difference, some lobes of P_b away, the peak is 0.
class ForwardPeak {
 public:
  ForwardPeak(const DeltaM& fine, const DeltaM& coarse);

  /// f_b - f_g; 0: no peak.
  double share() const { return share_; }
  /// At a cosine of the scattering angle; of both signs.
  double peak(double cos_angle) const;
  double rest(double cos_angle) const;

 private:
  double beyond(double cos_angle) const;

  DeltaM fine_;
  DeltaM coarse_;
  double share_;
  double cos_end_ = 1;  // of the angle at which the peak ends
};

struct PeakAngle {
  double cos_angle;
  double density;  ///< of the angles, per sr
};

/// `count` > 0 scattering angles distributed as the magnitude of sum_p weight_p peak_p, and a tenth of them wider than
/// that. They are at the middles of as many equal shares.
/// @param weight [p] >= 0, for peaks of share > 0 not all 0.
std::vector<PeakAngle> peak_angles(std::span<const ForwardPeak> peaks, std::span<const double> weight, int count);

}  // namespace cloudbow
