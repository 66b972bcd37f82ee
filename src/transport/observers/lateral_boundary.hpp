// Radiance at an open side: that of the layers alone, solved as one column. The surface below is black, unless there is
// thermal emission: then it has the mean albedo and the mean Planck radiance of the scene's.
#pragma once

#include <optional>
#include <vector>

#include "transport/system/transport_system.hpp"

namespace cloudbow {

class LateralBoundary {
 public:
  LateralBoundary(const Problem& problem, const Discretisation& discretisation, const SolverOptions& options);

  /// Diffuse radiance along a direction at each interface, by height.
  std::vector<double> radiance(const Direction& travel) const;
  /// The same without the light of the iteration's direct beam (set_first_order_beside_peak).
  std::vector<double> radiance_beside_peak(const Direction& travel) const;

 private:
  std::vector<double> march_in(const DirectionalSource<double>& from, const Direction& travel) const;

  Problem problem_;
  TransportSystem<double> system_;
  double from_ground_ = 0;  // radiance that leaves the surface
  std::optional<DirectionalSource<double>> source_;
  std::optional<DirectionalSource<double>> beside_peak_;
};

}  // namespace cloudbow
