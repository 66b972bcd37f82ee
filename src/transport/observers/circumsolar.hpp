// Circumsolar light: diffuse light from a cone about the sun. Instruments for direct light see it beside the sun's
// disc.
//
// Rays are marched through the box along directions of the cone. Light in the truncated forward peak has a march of its
// own. It is attenuated as the beam that carries it (docs/theory.md, Eqs. 32e and 32f).
#pragma once

#include "cloudbow/optics/circumsolar_phase.hpp"
#include "transport/iteration/source_iteration.hpp"
#include "transport/observers/converged_field.hpp"

namespace cloudbow {

/// The source towards the sun's direction of travel is computed while the radiance at the ordinates is in memory.
template <class Real>
class CircumsolarLight {
 public:
  /// @param field its radiance at the ordinates is still there. Its problem has a sun, and its options ask for this
  /// light.
  explicit CircumsolarLight(const ConvergedField<Real>& field);

  /// Fills circumsolar_flux of the solution at its flux levels.
  void fill(Solution& solution) const;

 private:
  struct Source;
  struct Ray;

  Source source_of(std::size_t ring) const;
  std::vector<Real> side_peak(std::size_t ring) const;
  std::vector<Ray> rays_of(std::size_t ring) const;
  void march(const Ray& ray, const Source& source, std::span<const int> plane, std::vector<Real>& flux) const;

  const ConvergedField<Real>& field_;
  std::vector<ConeRing> rings_;
  CircumsolarPhase phase_;
  std::vector<Real> carried_extinction_;        // [n + lane_padding] attenuates the light in the peak
  std::vector<float> place_;                    // [n] CircumsolarPhase::place of the depth of the peak
  std::vector<std::vector<Real>> first_order_;  // [p] intensity of SingleScattering; empty: p does not scatter
  std::vector<Real> higher_orders_;             // [n] source of light scattered twice or more, and of emission
};

/// Directions of the cone along which rays are marched, twice each.
inline constexpr int circumsolar_rings = 3;
inline constexpr int circumsolar_azimuths = 6;
/// Rays per column along each axis and direction.
int circumsolar_rays_across(const AngularOptions& options);

/// The most memory that it takes in values of `real` bytes, beside the source at the ordinates.
std::size_t circumsolar_bytes(std::size_t cells, std::size_t phases, std::size_t columns_at_levels, std::size_t real);

}  // namespace cloudbow
