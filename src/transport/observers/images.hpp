// Images of instruments: parallel views and cameras, from the converged radiance.
#pragma once

#include "transport/iteration/source_iteration.hpp"
#include "transport/observers/camera_view.hpp"
#include "transport/observers/converged_field.hpp"
#include "transport/observers/view.hpp"

namespace cloudbow {

/// The source towards all directions of view is computed while the radiance at the ordinates is in memory. The images
/// follow after the fluxes that light the ground.
template <class Real>
class Images {
 public:
  /// @param field its radiance at the ordinates is still there.
  explicit Images(const ConvergedField<Real>& field);

  /// Fills the images of the solution, whose fluxes at the ground, if it has them, light the surface.
  void fill(Solution& solution) const;

 private:
  const ConvergedField<Real>& field_;
  std::optional<SightPoints> sight_;  // of the cameras, if there are any
  std::vector<ViewingBeam<Real>> beams_;
  AngularField<Real> source_;  // views, all orders of scattering; cameras' points, orders >= 2
};

}  // namespace cloudbow
