// The source towards the directions that are looked along: light scattered once by the phase function itself, higher
// orders straight from the radiance at the ordinates (docs/theory.md, "Radiance").
#pragma once

#include <span>
#include <vector>

#include "cloudbow/transport/transport_system.hpp"

namespace cloudbow {

template <class Real>
struct SeenSource {
  std::vector<Direction> travel;                    ///< of the light that is seen
  AngularField<Real> higher_orders;                 ///< one row a direction: orders of scattering >= 2
  std::vector<SingleScattering<Real>> first_order;  ///< of the direct beam
  Direction sun_travel = -Direction::UnitZ();

  /// Source along travel[i].
  SourceAlong<Real> along(std::size_t i) const;
};

/// @param radiance of the converged iteration, at the ordinates; orders of scattering >= 1.
template <class Real>
SeenSource<Real> seen_source(const Problem& problem, const Discretisation& discretisation,
                             const TransportSystem<Real>& system, const AngularField<Real>& radiance,
                             std::span<const Direction> travel);

}  // namespace cloudbow
