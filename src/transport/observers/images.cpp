#include "transport/observers/images.hpp"

#include <algorithm>

#include "cloudbow/core/not_negative.hpp"
#include "transport/iteration/source_iteration.hpp"

namespace cloudbow {
namespace {

// Light at the ground: the final gather's where the solution holds it, else the ordinates'.
template <class Real>
GroundRadiance<Real> lit_ground(const TransportSystem<Real>& system, const SweepFluxes<Real>& fluxes,
                                const Solution& solution) {
  const bool gathered = !solution.flux_level.empty() && solution.flux_level.front() == 0;
  std::vector<double> diffuse = fluxes.surface_flux;
  if (gathered) {
    for (std::size_t c = 0; c < diffuse.size(); ++c)
      diffuse[c] = static_cast<double>(solution.downwelling_diffuse_flux[c]) + solution.direct_flux[c];
  }
  for (std::size_t c = 0; c < system.beam_surface_flux.size(); ++c)
    diffuse[c] = not_negative(diffuse[c] - system.beam_surface_flux[c]);
  return system.ground.radiance_seen(fluxes.surface_arriving, diffuse, system.beam_surface_flux, system.ordinates);
}

}  // namespace

template <class Real>
Images<Real>::Images(const Problem& problem, const Discretisation& discretisation, const SolverOptions& options,
                     const TransportSystem<Real>& system, const IterationResult<Real>& solved,
                     const LateralBoundary* lateral_boundary)
    : problem_(problem), options_(options), system_(system), lateral_boundary_(lateral_boundary) {
  std::vector<Direction> travel;
  for (const View& view : options.views) travel.push_back(view.travel);
  if (!options.cameras.empty()) {
    sight_ = sight_points(options.cameras, system.cells->size());
    travel.insert(travel.end(), sight_->travel.begin(), sight_->travel.end());
  }
  if (travel.empty()) return;
  beams_ = viewing_beams(problem, discretisation, options, system);
  source_ = higher_orders_seen(problem, discretisation, system, solved, lateral_boundary, travel);
  for (std::size_t v = 0; v < options.views.size(); ++v) {
    Real* const row = source_.row(static_cast<int>(v));
    for (const ViewingBeam<Real>& beam : beams_)
      add_first_order<Real>(beam, travel[v].dot(problem.sun->travel), {row, source_.cells});
  }
}

template <class Real>
void Images<Real>::fill(const IterationResult<Real>& solved, Solution& solution) const {
  if (source_.rows == 0) return;
  const GroundRadiance<Real> ground = lit_ground(system_, solved.fluxes, solution);
  SideRadiance side;
  if (lateral_boundary_ != nullptr)
    side = [this](const Direction& travel) { return lateral_boundary_->radiance(travel); };
  solution.images = view_radiances(problem_, options_, system_, source_, ground, side);
  if (sight_) {
    solution.camera_images = camera_images<Real>(problem_, options_, system_, *sight_, source_,
                                                 static_cast<int>(options_.views.size()), beams_, ground, side);
  }
}

template class Images<float>;
template class Images<double>;

}  // namespace cloudbow
