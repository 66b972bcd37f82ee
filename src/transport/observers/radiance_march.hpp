// Voxel-mean diffuse radiance of all cells along any one direction.
#pragma once

#include <span>
#include <vector>

#include "transport/observers/lateral_boundary.hpp"
#include "transport/system/transport_system.hpp"

namespace cloudbow {

/// The ground as the iteration lights it.
template <class Real>
GroundRadiance<Real> ground_of_iteration(const TransportSystem<Real>& system, const SweepFluxes<Real>& fluxes);

/// One march through the box; its memory lasts from call to call.
template <class Real>
class RadianceMarch {
 public:
  /// @param lateral_boundary radiance at open sides; may be null.
  /// @param source [n] towards `travel`
  /// @return [n] valid until the next call
  std::span<const Real> mean_radiance(const Problem& problem, const TransportSystem<Real>& system,
                                      const GroundRadiance<Real>& ground, const LateralBoundary* lateral_boundary,
                                      const Direction& travel, std::span<const Real> source);

 private:
  LinearSource<Real> linear_;
  std::vector<Real> radiance_, rays_, side_, from_ground_;
};

}  // namespace cloudbow
