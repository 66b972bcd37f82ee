#include "transport/observers/images.hpp"

#include <algorithm>

#include "cloudbow/core/not_negative.hpp"
#include "transport/iteration/source_iteration.hpp"

namespace cloudbow {
namespace {

// Light at the ground: that of the final gather if the solution holds it, else that of the ordinates.
template <class Real>
GroundRadiance<Real> lit_ground(const TransportSystem<Real>& system, const SweepFluxes<Real>& fluxes,
                                const Solution& solution) {
  const bool gathered = !solution.flux_level.empty() && solution.flux_level.front() == 0;
  std::vector<double> diffuse = fluxes.surface_flux;
  if (gathered) {
    for (std::size_t c = 0; c < diffuse.size(); ++c)
      diffuse[c] = static_cast<double>(solution.downwelling_diffuse_flux[c]) + solution.direct_flux[c];
  }
  for (std::size_t c = 0; c < system.beam.surface_flux.size(); ++c)
    diffuse[c] = not_negative(diffuse[c] - system.beam.surface_flux[c]);
  return system.ground.radiance_seen(fluxes.surface_arriving, diffuse, system.beam.surface_flux, system.ordinates);
}

}  // namespace

template <class Real>
Images<Real>::Images(const ConvergedField<Real>& field) : field_(field) {
  const SolverOptions& options = field.options;
  std::vector<Direction> travel;
  for (const View& view : options.views) travel.push_back(view.travel);
  if (!options.cameras.empty()) {
    sight_ = sight_points(options.cameras, field.system.cells->size());
    travel.insert(travel.end(), sight_->travel.begin(), sight_->travel.end());
  }
  if (travel.empty()) return;
  source_ = higher_orders_seen<Real>(field, travel);
  if (!field.is_first()) return;
  beams_ = viewing_beams(field);
  for (std::size_t v = 0; v < options.views.size(); ++v) {
    Real* const row = source_.row(static_cast<int>(v));
    for (const ViewingBeam<Real>& beam : beams_)
      add_first_order<Real>(beam, travel[v].dot(field.problem.sun->travel), {row, source_.cells});
  }
}

template <class Real>
void Images<Real>::fill(Solution& solution) const {
  if (source_.rows == 0) return;
  const GroundRadiance<Real> ground = lit_ground(field_.system, field_.result.fluxes, solution);
  SideRadiance side;
  if (const LateralBoundary* const outside = field_.lateral_boundary; outside != nullptr)
    side = [outside](const Direction& travel) { return outside->radiance(travel); };
  solution.images = view_radiances<Real>(field_, source_, beams_, ground, side);
  if (sight_) {
    solution.camera_images = camera_images<Real>(field_, *sight_, source_,
                                                 static_cast<int>(field_.options.views.size()), beams_, ground, side);
  }
}

template class Images<float>;
template class Images<double>;

}  // namespace cloudbow
