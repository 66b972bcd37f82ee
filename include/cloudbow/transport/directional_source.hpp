// The converged source in any direction: scattered light from the control points, the direct beam's first scattering
// from its phase function itself.
#pragma once

#include <vector>

#include "cloudbow/optics/phase_function.hpp"
#include "cloudbow/sphere/control_points.hpp"
#include "cloudbow/transport/scattering.hpp"

namespace cloudbow {

/// First scattering of a beam: source = phase(Omega . sun) * intensity[n].
template <class Real>
struct SingleScattering {
  PhaseFunction phase;
  std::vector<Real> intensity;
};

template <class Real>
struct DirectionalSource {
  ControlPoints points;
  AngularField<Real> at_points;  ///< orders of scattering >= 2 (and the first of sky and surface light)
  Direction sun_travel = -Direction::UnitZ();
  std::vector<SingleScattering<Real>> first_order;

  /// Source of all cells for light that travels along `direction`: three streams times three weights, and one more a
  /// beam.
  void query(const Direction& direction, Real* source) const;
};

}  // namespace cloudbow
