// The source towards the directions of view. Light scattered once uses the phase function itself; higher orders use the
// radiance at the ordinates directly (docs/theory.md, "Radiance").
#pragma once

#include <span>
#include <vector>

#include "cloudbow/optics/beam_phase.hpp"
#include "transport/iteration/source_iteration.hpp"
#include "transport/observers/converged_field.hpp"
#include "transport/observers/lateral_boundary.hpp"
#include "transport/system/transport_system.hpp"

namespace cloudbow {

/// The direct beam as it is seen: how much one phase function scatters, and through how much of its peak the light
/// went.
template <class Real>
struct ViewingBeam {
  BeamPhase phase;
  std::vector<Real> intensity;  ///< [n] as SingleScattering's
  std::vector<float> place;     ///< [n] BeamPhase::place of the peak's optical depth
};

/// Empty for a problem without sun.
template <class Real>
std::vector<ViewingBeam<Real>> viewing_beams(const ConvergedField<Real>& field);

/// A line along the horizon never ends; the direction just above or below replaces it. Travel that is level counts as
/// upward.
Direction off_the_horizon(const Direction& travel);

/// Orders of scattering >= 2, and thermal emission: one row for each direction of travel.
///
/// The radiance I_d at the ordinates scatters by the phase function itself. Its truncated form has large errors at the
/// angles of little light. The forward peak, too narrow for the ordinates, is subtracted: with I_v the radiance along
/// the direction itself (marched once) and f the fraction that transport counts as unscattered,
///     S = w/(4 pi) (sum_d w_d P(v . d) (I_d - I_v) + 4 pi (1 - f) I_v) / (1 - w f).
/// @param field whose radiance is that at the ordinates, orders of scattering >= 1. All ranks that share it call this.
/// The first has the source.
template <class Real>
AngularField<Real> higher_orders_seen(const ConvergedField<Real>& field, std::span<const Direction> travel);

/// Slopes of that source within cells, relative to the whole source and limited, from those of the radiance.
/// @param travel directions of one octant: the source and its slopes are means over them.
/// @param source, from_beam [n] the whole source and the first order of scattering in it.
template <class Real>
Slope<Real> slopes_seen(const ConvergedField<Real>& field, std::span<const Direction> travel,
                        std::span<const Real> source, std::span<const Real> from_beam);

/// Adds the first order of scattering into one direction.
template <class Real>
void add_first_order(const ViewingBeam<Real>& beam, double cos_angle, std::span<Real> source);

}  // namespace cloudbow
