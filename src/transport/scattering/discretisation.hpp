// Control points, ordinates and the representation of each phase function on them.
#pragma once

#include <optional>
#include <vector>

#include "cloudbow/optics/delta_m.hpp"
#include "cloudbow/optics/forward_peak.hpp"
#include "cloudbow/optics/scattering_table.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

struct Discretisation {
  ControlPoints points;
  OrdinateSet ordinates;
  std::vector<ScatteringTable> table;  ///< [p]
  std::vector<DeltaM> diffuse;         ///< [p] truncated at N: scattering of the iteration
  std::vector<DeltaM> beam;            ///< [p] truncated at N_b: how the iteration's direct beam scatters
  std::vector<DeltaM> gather;          ///< [p] truncated at gather_order: resolution of the gather's single scattering
  std::vector<ForwardPeak> peak;       ///< [p] of share f_b: scattering that stays in the iteration's direct beam

  /// Order to which the gather's directions about the sun (some two degrees apart) resolve a forward peak; a narrower
  /// core stays in the beam.
  static constexpr int gather_order = 48;

  std::vector<double> diffuse_fraction() const;
  std::vector<double> beam_fraction() const;
  std::vector<double> gather_fraction() const;
};

/// @throws InputError for names and counts that do not exist.
Discretisation discretise(const std::vector<PhaseFunction>& phase, const std::optional<Direction>& sun_travel,
                          const AngularOptions& options);

}  // namespace cloudbow
